// Keeps four rows of a grid, in two memories, so that the nodes above and below a row of cells are read at once.
// The rows come in order; row r is accepted as soon as row r - 4 is no longer needed.
module remap_nodes (
  input  logic                          clk_i,
  input  logic                          rst_ni,     // asynchronous, active low
  input  logic                          clear_i,
  input  logic                          start_i,    // nodes_i and rows_i hold from the next cycle on
  input  logic [remap_pkg::NodeBits:0]  nodes_i,    // of a row, 2 to MaxNodes
  input  logic [remap_pkg::RowBits:0]   rows_i,     // of the grid
  input  logic                          map_valid_i,
  output logic                          map_ready_o,
  input  logic [31:0]                   map_i,      // offsets of a node: x in the low half, y in the high half
  input  logic [remap_pkg::RowBits-1:0] cell_row_i, // its nodes are rows cell_row_i and cell_row_i + 1
  output logic                          there_o,    // both of them are there
  input  logic                          read_i,
  input  logic [remap_pkg::NodeBits-1:0] node_i,
  output logic [31:0]                   above_o,    // the cycle after read_i
  output logic [31:0]                   below_o
);
  logic [31:0] even [0:2*remap_pkg::MaxNodes-1];
  logic [31:0] odd [0:2*remap_pkg::MaxNodes-1];
  logic [remap_pkg::RowBits:0]    rows_there;  // complete ones
  logic [remap_pkg::NodeBits-1:0] node;        // next to come
  logic                           loading;
  logic                           take, row_end;
  logic [remap_pkg::RowBits:0]    cell_row;

  assign cell_row = {1'b0, cell_row_i};
  assign map_ready_o = loading && rows_there < cell_row + 13'd4;
  assign take = map_valid_i && map_ready_o;
  assign row_end = {1'b0, node} + 9'd1 == nodes_i;
  assign there_o = rows_there >= cell_row + 13'd2;

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      rows_there <= '0;
      node <= '0;
      loading <= 1'b0;
    end else if (clear_i) begin
      loading <= 1'b0;
      rows_there <= '0;
    end else if (start_i) begin
      rows_there <= '0;
      node <= '0;
      loading <= 1'b1;
    end else if (take) begin
      node <= row_end ? '0 : node + 1'b1;
      if (row_end) begin
        rows_there <= rows_there + 1'b1;
        if (rows_there + 1'b1 == rows_i) loading <= 1'b0;
      end
    end

  // A row of cells with an even number has its upper nodes in `even`, the next one in `odd`.
  logic [remap_pkg::RowBits-1:0] next_row;
  logic [remap_pkg::NodeBits:0]  even_at, odd_at;
  logic [31:0]                   even_q, odd_q;
  logic                          swap;
  assign next_row = cell_row_i + 1'b1;
  assign even_at = {cell_row_i[0] ? next_row[1] : cell_row_i[1], node_i};
  assign odd_at = {cell_row_i[1], node_i};
  assign above_o = swap ? odd_q : even_q;
  assign below_o = swap ? even_q : odd_q;
  always_ff @(posedge clk_i) begin
    if (take && !rows_there[0]) even[{rows_there[1], node}] <= map_i;
    if (take && rows_there[0]) odd[{rows_there[1], node}] <= map_i;
    if (read_i) begin
      even_q <= even[even_at];
      odd_q <= odd[odd_at];
      swap <= cell_row_i[0];
    end
  end
  logic unused;
  assign unused = ^{next_row[remap_pkg::RowBits-1:2], next_row[0]};

`ifdef FORMAL
  `include "remap_nodes_props.svh"
`endif
endmodule
