// Walks over the pairs of a job in raster order and gives the three linear forms of each.
// Throughput: one pair per cycle while ready_i is high.
module remap_scan (
  input  logic                                 clk_i,
  input  logic                                 rst_ni,   // asynchronous, active low
  input  logic                                 clear_i,
  input  logic                                 start_i,  // while idle: begins with job_i
  input  remap_pkg::job_t                      job_i,    // constant until the last pair is taken
  output logic                                 valid_o,
  input  logic                                 ready_i,
  output logic signed [remap_pkg::FormBits-1:0] a_o,
  output logic signed [remap_pkg::FormBits-1:0] b_o,
  output logic signed [remap_pkg::FormBits-1:0] c_o
);
  localparam int unsigned B = remap_pkg::FormBits;
  logic [remap_pkg::PairBits-1:0] pair;
  logic [remap_pkg::RowBits-1:0]  row;
  logic [B-1:0] a_row, b_row, c_row;    // the forms at the row's first pair
  logic [B-1:0] a1, a2, b1, b2, c1, c2; // steps, sign-extended
  logic row_end, job_end;

  assign a1 = {{(B-32){job_i.a1[31]}}, job_i.a1};
  assign a2 = {{(B-32){job_i.a2[31]}}, job_i.a2};
  assign b1 = {{(B-32){job_i.b1[31]}}, job_i.b1};
  assign b2 = {{(B-32){job_i.b2[31]}}, job_i.b2};
  assign c1 = {{(B-32){job_i.c1[31]}}, job_i.c1};
  assign c2 = {{(B-32){job_i.c2[31]}}, job_i.c2};
  assign row_end = {1'b0, pair} + 12'd1 == job_i.pairs;
  assign job_end = row_end && {1'b0, row} + 13'd1 == job_i.rows;

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      valid_o <= 1'b0;
      pair <= '0;
      row <= '0;
      a_o <= '0;
      b_o <= '0;
      c_o <= '0;
      a_row <= '0;
      b_row <= '0;
      c_row <= '0;
    end else if (clear_i) begin
      valid_o <= 1'b0;
    end else if (start_i && !valid_o) begin
      valid_o <= 1'b1;
      pair <= '0;
      row <= '0;
      a_o <= {{(B-32){job_i.a0[31]}}, job_i.a0};
      b_o <= {{(B-32){job_i.b0[31]}}, job_i.b0};
      c_o <= {{(B-32){job_i.c0[31]}}, job_i.c0};
      a_row <= {{(B-32){job_i.a0[31]}}, job_i.a0};
      b_row <= {{(B-32){job_i.b0[31]}}, job_i.b0};
      c_row <= {{(B-32){job_i.c0[31]}}, job_i.c0};
    end else if (valid_o && ready_i) begin
      valid_o <= !job_end;
      if (row_end) begin
        pair <= '0;
        row <= row + 1'b1;
        a_o <= a_row + a2;
        b_o <= b_row + b2;
        c_o <= c_row + c2;
        a_row <= a_row + a2;
        b_row <= b_row + b2;
        c_row <= c_row + c2;
      end else begin
        pair <= pair + 1'b1;
        a_o <= a_o + a1;
        b_o <= b_o + b1;
        c_o <= c_o + c1;
      end
    end

`ifdef FORMAL
  `include "remap_scan_props.svh"
`endif
endmodule
