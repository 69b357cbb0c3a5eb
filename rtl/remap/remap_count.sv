// Counts the pairs of a job.
module remap_count (
  input  logic            clk_i,
  input  logic            rst_ni,   // asynchronous, active low
  input  logic            clear_i,
  input  logic            start_i,  // begins with job_i
  input  remap_pkg::job_t job_i,    // constant until the last pair
  input  logic            step_i,   // a pair
  output logic            busy_o    // pairs are left
);
  logic [29:0] dst;
  logic        last, unused;
  remap_place u_place (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .start_i(start_i), .job_i(job_i),
    .step_i(step_i), .busy_o(busy_o), .dst_o(dst), .last_o(last)
  );
  assign unused = ^{dst, last};
endmodule
