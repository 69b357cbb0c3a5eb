// Offsets of the source positions, interpolated bilinearly in a grid with a node every 2^grid_log2 pixels.
// An edge is the column of positions that a node column has in one output row; two edges bound the pairs between them,
// on which the offset changes by the same step from pair to pair.
module remap_grid (
  input  logic               clk_i,
  input  logic               rst_ni,   // asynchronous, active low
  input  logic               clear_i,
  input  logic               start_i,  // the nodes of job_i follow on map_i
  input  remap_pkg::job_t    job_i,    // constant until the last offset is taken
  input  logic               map_valid_i,
  output logic               map_ready_o,
  input  logic [31:0]        map_i,
  output logic               valid_o,
  input  logic               ready_i,
  output logic signed [27:0] x_o,      // pixels, Q16
  output logic signed [27:0] y_o
);
  localparam int unsigned EdgeBits = 22;  // Q10
  logic [12:0] step, cells, node_rows;
  logic [5:0]  step_mask;
  assign step = 13'd1 << job_i.grid_log2;
  assign step_mask = step[5:0] - 6'd1;
  assign cells = ({job_i.pairs, 1'b0} + step - 13'd1) >> job_i.grid_log2;
  assign node_rows = ((job_i.rows + step - 13'd1) >> job_i.grid_log2) + 13'd1;

  // The walk over edges: node by node in every output row.
  logic                          walking;
  logic [remap_pkg::RowBits-1:0] row, cell_row;
  logic [remap_pkg::NodeBits-1:0] node;
  logic there, issue, go, node_end, row_end;
  assign cell_row = row >> job_i.grid_log2;
  assign issue = go && walking && there;
  assign node_end = {5'd0, node} == cells;
  assign row_end = {1'b0, row} + 13'd1 == job_i.rows;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      walking <= 1'b0;
      row <= '0;
      node <= '0;
    end else if (clear_i) begin
      walking <= 1'b0;
    end else if (start_i) begin
      walking <= 1'b1;
      row <= '0;
      node <= '0;
    end else if (issue) begin
      node <= node_end ? '0 : node + 1'b1;
      if (node_end) begin
        row <= row + 1'b1;
        walking <= !row_end;
      end
    end

  logic [31:0] above, below;
  remap_nodes u_nodes (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .start_i(start_i),
    .nodes_i(cells[remap_pkg::NodeBits:0] + 9'd1), .rows_i(node_rows),
    .map_valid_i(map_valid_i), .map_ready_o(map_ready_o), .map_i(map_i),
    .cell_row_i(cell_row), .there_o(there), .read_i(issue), .node_i(node),
    .above_o(above), .below_o(below)
  );

  // 1: the nodes are there. 2: the edge is, and the one before it.
  logic v1, v2, first1, first2;
  logic [5:0] fy1;
  logic signed [EdgeBits-1:0] edge_x2, edge_y2, left_x, left_y;
  logic signed [7:0]  weight_above, weight_below;
  logic signed [23:0] sum_x, sum_y, wide_x, wide_y;
  logic [2:0] up;
  assign weight_above = $signed({1'b0, step[6:0]}) - $signed({2'b00, fy1});
  assign weight_below = $signed({2'b00, fy1});
  assign sum_x = $signed(above[15:0]) * weight_above + $signed(below[15:0]) * weight_below;
  assign sum_y = $signed(above[31:16]) * weight_above + $signed(below[31:16]) * weight_below;
  assign up = 3'd6 - job_i.grid_log2;
  assign wide_x = sum_x <<< up;
  assign wide_y = sum_y <<< up;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      v1 <= 1'b0;
      v2 <= 1'b0;
    end else if (clear_i) begin
      v1 <= 1'b0;
      v2 <= 1'b0;
    end else if (go) begin
      v1 <= issue;
      v2 <= v1;
    end
  always_ff @(posedge clk_i)
    if (go) begin
      first1 <= node == '0;
      fy1 <= row[5:0] & step_mask;
      if (v1) begin
        first2 <= first1;
        edge_x2 <= wide_x[EdgeBits-1:0];
        edge_y2 <= wide_y[EdgeBits-1:0];
      end
      if (v2) begin
        left_x <= edge_x2;
        left_y <= edge_y2;
      end
    end

  // Cells: the left edge, and the way to the right one.
  logic cell_valid, cell_ready, cell_in, cell_space;
  logic [4*EdgeBits+1:0] cell_data, cell_next;
  logic signed [EdgeBits:0] way_x, way_y;
  logic [2:0] cell_count;
  assign way_x = $signed({edge_x2[EdgeBits-1], edge_x2}) - $signed({left_x[EdgeBits-1], left_x});
  assign way_y = $signed({edge_y2[EdgeBits-1], edge_y2}) - $signed({left_y[EdgeBits-1], left_y});
  assign cell_in = v2 && !first2;
  assign go = !cell_in || cell_space;
  assign cell_data = {left_x, way_x, left_y, way_y};
  remap_fifo #(.Width(4 * EdgeBits + 2), .LogDepth(2)) u_cells (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i),
    .valid_i(cell_in), .ready_o(cell_space), .data_i(cell_data),
    .valid_o(cell_valid), .ready_i(cell_ready), .data_o(cell_next), .count_o(cell_count)
  );

  // Pairs.
  logic signed [27:0] step_x, step_y;
  logic [4:0]  left;                    // pairs of this cell behind this one
  logic [remap_pkg::PairBits-1:0] after;  // pairs of this row behind this cell, less one
  logic        row_start;
  logic [11:0] rest, in_cell;
  logic [2:0]  pair_up;
  logic [EdgeBits-1:0] next_x, next_y;
  logic [EdgeBits:0]   next_way_x, next_way_y;
  logic signed [27:0]  long_x, long_y;
  assign {next_x, next_way_x, next_y, next_way_y} = cell_next;
  assign long_x = {{5{next_way_x[EdgeBits]}}, next_way_x};
  assign long_y = {{5{next_way_y[EdgeBits]}}, next_way_y};
  assign pair_up = 3'd7 - job_i.grid_log2;
  assign rest = row_start ? job_i.pairs : {1'b0, after} + 12'd1;
  assign in_cell = rest < step[12:1] ? rest : step[12:1];
  assign cell_ready = !valid_o || (ready_i && left == '0);
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      valid_o <= 1'b0;
      row_start <= 1'b1;
      left <= '0;
      after <= '0;
      x_o <= '0;
      y_o <= '0;
      step_x <= '0;
      step_y <= '0;
    end else if (clear_i || start_i) begin
      valid_o <= 1'b0;
      row_start <= 1'b1;
    end else if (cell_ready) begin
      valid_o <= cell_valid;
      if (cell_valid) begin
        x_o <= {next_x, 6'd0};
        y_o <= {next_y, 6'd0};
        step_x <= long_x <<< pair_up;
        step_y <= long_y <<< pair_up;
        left <= in_cell[4:0] - 5'd1;
        row_start <= rest == in_cell;
        after <= rest[10:0] - in_cell[10:0] - 11'd1;
      end
    end else if (ready_i) begin
      x_o <= x_o + step_x;
      y_o <= y_o + step_y;
      left <= left - 1'b1;
    end

  logic unused;
  assign unused = ^{cell_count, in_cell[11], wide_x[23:EdgeBits], wide_y[23:EdgeBits]};

`ifdef FORMAL
  `include "remap_stream_props.svh"
`endif
endmodule
