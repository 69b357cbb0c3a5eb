// The remap engine as a device on a chip: registers behind an AXI4-Lite slave, a queue of jobs, an interrupt, and an
// AXI4 master with 64 bits.
module remap_top #(
  parameter int unsigned LogLines = 8,   // of the source cache, 32 bytes each: 3 to 12
  parameter int unsigned Prefetch = 8,   // lines of the source under way at most: 1 to 8
  parameter int unsigned QueueDepth = 4  // jobs that can wait: 2, 4 or 8
) (
  input  logic        clk_i,
  input  logic        rst_ni,        // asynchronous, active low
  output logic        irq_o,         // level
  output logic        busy_o,        // an access or a job needs clocks
  input  logic        s_aw_valid_i,
  output logic        s_aw_ready_o,
  input  logic [9:0]  s_aw_addr_i,
  input  logic        s_w_valid_i,
  output logic        s_w_ready_o,
  input  logic [31:0] s_w_data_i,
  input  logic [3:0]  s_w_strb_i,
  output logic        s_b_valid_o,
  input  logic        s_b_ready_i,
  output logic [1:0]  s_b_resp_o,
  input  logic        s_ar_valid_i,
  output logic        s_ar_ready_o,
  input  logic [9:0]  s_ar_addr_i,
  output logic        s_r_valid_o,
  input  logic        s_r_ready_i,
  output logic [31:0] s_r_data_o,
  output logic [1:0]  s_r_resp_o,
  output logic        ar_valid_o,
  input  logic        ar_ready_i,
  output logic        ar_id_o,
  output logic [31:0] ar_addr_o,
  output logic [7:0]  ar_len_o,
  input  logic        r_valid_i,
  output logic        r_ready_o,
  input  logic        r_id_i,
  input  logic [63:0] r_data_i,
  input  logic [1:0]  r_resp_i,
  output logic        aw_valid_o,
  input  logic        aw_ready_i,
  output logic [31:0] aw_addr_o,
  output logic [7:0]  aw_len_o,
  output logic        w_valid_o,
  input  logic        w_ready_i,
  output logic [63:0] w_data_o,
  output logic [7:0]  w_strb_o,
  output logic        w_last_o,
  input  logic        b_valid_i,
  output logic        b_ready_o,
  input  logic [1:0]  b_resp_i
);
  logic            job_valid, job_ready, abort, done, refused, read_error, write_error, aborted;
  remap_pkg::job_t job;
  logic [25:0]     map_base;
  logic [23:0]     map_words;
  logic [31:0]     border, clocks, lines, writes, bad;
  remap_regs #(.QueueDepth(QueueDepth)) u_regs (
    .clk_i(clk_i), .rst_ni(rst_ni), .irq_o(irq_o), .busy_o(busy_o),
    .s_aw_valid_i(s_aw_valid_i), .s_aw_ready_o(s_aw_ready_o), .s_aw_addr_i(s_aw_addr_i),
    .s_w_valid_i(s_w_valid_i), .s_w_ready_o(s_w_ready_o), .s_w_data_i(s_w_data_i), .s_w_strb_i(s_w_strb_i),
    .s_b_valid_o(s_b_valid_o), .s_b_ready_i(s_b_ready_i), .s_b_resp_o(s_b_resp_o),
    .s_ar_valid_i(s_ar_valid_i), .s_ar_ready_o(s_ar_ready_o), .s_ar_addr_i(s_ar_addr_i),
    .s_r_valid_o(s_r_valid_o), .s_r_ready_i(s_r_ready_i), .s_r_data_o(s_r_data_o), .s_r_resp_o(s_r_resp_o),
    .job_valid_o(job_valid), .job_ready_i(job_ready), .job_o(job),
    .map_base_o(map_base), .map_words_o(map_words), .border_o(border), .abort_o(abort),
    .done_i(done), .refused_i(refused), .read_error_i(read_error), .write_error_i(write_error), .aborted_i(aborted),
    .clocks_i(clocks), .lines_i(lines), .writes_i(writes), .bad_i(bad)
  );
  remap_engine #(.LogLines(LogLines), .Prefetch(Prefetch)) u_engine (
    .clk_i(clk_i), .rst_ni(rst_ni), .job_valid_i(job_valid), .job_ready_o(job_ready), .job_i(job),
    .map_base_i(map_base), .map_words_i(map_words), .border_i(border), .abort_i(abort),
    .done_o(done), .refused_o(refused), .read_error_o(read_error), .write_error_o(write_error), .aborted_o(aborted),
    .clocks_o(clocks), .lines_o(lines), .writes_o(writes), .bad_o(bad),
    .ar_valid_o(ar_valid_o), .ar_ready_i(ar_ready_i), .ar_id_o(ar_id_o), .ar_addr_o(ar_addr_o), .ar_len_o(ar_len_o),
    .r_valid_i(r_valid_i), .r_ready_o(r_ready_o), .r_id_i(r_id_i), .r_data_i(r_data_i), .r_resp_i(r_resp_i),
    .aw_valid_o(aw_valid_o), .aw_ready_i(aw_ready_i), .aw_addr_o(aw_addr_o), .aw_len_o(aw_len_o),
    .w_valid_o(w_valid_o), .w_ready_i(w_ready_i), .w_data_o(w_data_o), .w_strb_o(w_strb_o), .w_last_o(w_last_o),
    .b_valid_i(b_valid_i), .b_ready_o(b_ready_o), .b_resp_i(b_resp_i)
  );
endmodule
