// Counts the pairs of a job at the end of the pipeline: the destination of each, and which is the last.
module remap_place (
  input  logic            clk_i,
  input  logic            rst_ni,   // asynchronous, active low
  input  logic            clear_i,
  input  logic            start_i,  // begins with job_i
  input  remap_pkg::job_t job_i,    // constant until the last pair is taken
  input  logic            step_i,   // the pair is taken
  output logic            busy_o,   // pairs are left
  output logic [29:0]     dst_o,    // word address of the pair
  output logic            last_o
);
  logic [remap_pkg::PairBits-1:0] pair;
  logic [remap_pkg::RowBits-1:0]  row;
  logic [29:0]                    row_dst;
  logic                           row_end;

  assign row_end = {1'b0, pair} + 12'd1 == job_i.pairs;
  assign last_o = row_end && {1'b0, row} + 13'd1 == job_i.rows;

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      busy_o <= 1'b0;
      pair <= '0;
      row <= '0;
      dst_o <= '0;
      row_dst <= '0;
    end else if (clear_i) begin
      busy_o <= 1'b0;
    end else if (start_i && !busy_o) begin
      busy_o <= 1'b1;
      pair <= '0;
      row <= '0;
      dst_o <= job_i.dst_base;
      row_dst <= job_i.dst_base;
    end else if (busy_o && step_i) begin
      busy_o <= !last_o;
      if (row_end) begin
        pair <= '0;
        row <= row + 1'b1;
        dst_o <= row_dst + {17'd0, job_i.dst_pitch};
        row_dst <= row_dst + {17'd0, job_i.dst_pitch};
      end else begin
        pair <= pair + 1'b1;
        dst_o <= dst_o + 30'd1;
      end
    end

`ifdef FORMAL
  `include "remap_place_props.svh"
`endif
endmodule
