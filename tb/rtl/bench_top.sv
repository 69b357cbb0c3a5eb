// What the block tests see: address generator and engine, which share the ports of the job, one for each field, as C++
// cannot name fields of a packed structure.
module bench_top (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        ag_clear_i,
  input  logic        ag_job_valid_i,
  output logic        ag_job_ready_o,
  output logic        ag_job_refused_o,
  output logic        ag_busy_o,
  input  logic [1:0]  ag_mode_i,
  input  logic        ag_bilinear_i,
  input  logic [11:0] ag_pairs_i,
  input  logic [12:0] ag_rows_i,
  input  logic [29:0] ag_src_base_i,
  input  logic [12:0] ag_src_pitch_i,
  input  logic [12:0] ag_src_width_i,
  input  logic [12:0] ag_src_height_i,
  input  logic [29:0] ag_dst_base_i,
  input  logic [12:0] ag_dst_pitch_i,
  input  logic [2:0]  ag_grid_log2_i,
  input  logic [7:0]  ag_pieces_i,
  input  logic [4:0]  ag_piece_log2_i,
  input  logic [31:0] ag_radius_limit_i,
  input  logic [31:0] ag_centre_x_i,
  input  logic [31:0] ag_centre_y_i,
  input  logic [31:0] ag_a0_i,
  input  logic [31:0] ag_a1_i,
  input  logic [31:0] ag_a2_i,
  input  logic [31:0] ag_b0_i,
  input  logic [31:0] ag_b1_i,
  input  logic [31:0] ag_b2_i,
  input  logic [31:0] ag_c0_i,
  input  logic [31:0] ag_c1_i,
  input  logic [31:0] ag_c2_i,
  input  logic        ag_map_valid_i,
  output logic        ag_map_ready_o,
  input  logic [31:0] ag_map_i,
  output logic        ag_beat_valid_o,
  input  logic        ag_beat_ready_i,
  output logic        ag_last_o,
  output logic        ag_border_o,
  output logic        ag_bad_o,
  output logic        ag_edge_x_o,
  output logic        ag_edge_y_o,
  output logic        ag_odd_o,
  output logic [7:0]  ag_frac_x_o,
  output logic [7:0]  ag_frac_y_o,
  output logic [29:0] ag_src_o,
  output logic [29:0] ag_dst_o,
  input  logic        en_job_valid_i,
  output logic        en_job_ready_o,
  input  logic [25:0] en_map_base_i,
  input  logic [23:0] en_map_words_i,
  input  logic [31:0] en_border_i,
  input  logic        en_abort_i,
  output logic        en_done_o,
  output logic        en_refused_o,
  output logic        en_read_error_o,
  output logic        en_write_error_o,
  output logic        en_aborted_o,
  output logic [31:0] en_clocks_o,
  output logic [31:0] en_lines_o,
  output logic [31:0] en_writes_o,
  output logic [31:0] en_bad_o,
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
  remap_pkg::job_t  job;
  remap_pkg::beat_t beat;
  always_comb begin
    job.mode = remap_pkg::mode_e'(ag_mode_i);
    job.bilinear = ag_bilinear_i;
    job.pairs = ag_pairs_i;
    job.rows = ag_rows_i;
    job.src_base = ag_src_base_i;
    job.src_pitch = ag_src_pitch_i;
    job.src_width = ag_src_width_i;
    job.src_height = ag_src_height_i;
    job.dst_base = ag_dst_base_i;
    job.dst_pitch = ag_dst_pitch_i;
    job.grid_log2 = ag_grid_log2_i;
    job.pieces = ag_pieces_i;
    job.piece_log2 = ag_piece_log2_i;
    job.radius_limit = ag_radius_limit_i;
    job.centre_x = ag_centre_x_i;
    job.centre_y = ag_centre_y_i;
    job.a0 = ag_a0_i;
    job.a1 = ag_a1_i;
    job.a2 = ag_a2_i;
    job.b0 = ag_b0_i;
    job.b1 = ag_b1_i;
    job.b2 = ag_b2_i;
    job.c0 = ag_c0_i;
    job.c1 = ag_c1_i;
    job.c2 = ag_c2_i;
  end
  remap_addrgen u_addrgen (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(ag_clear_i),
    .job_valid_i(ag_job_valid_i), .job_ready_o(ag_job_ready_o), .job_i(job),
    .job_refused_o(ag_job_refused_o), .busy_o(ag_busy_o),
    .map_valid_i(ag_map_valid_i), .map_ready_o(ag_map_ready_o), .map_i(ag_map_i),
    .beat_valid_o(ag_beat_valid_o), .beat_ready_i(ag_beat_ready_i), .beat_o(beat)
  );
  remap_engine u_engine (
    .clk_i(clk_i), .rst_ni(rst_ni), .job_valid_i(en_job_valid_i), .job_ready_o(en_job_ready_o), .job_i(job),
    .map_base_i(en_map_base_i), .map_words_i(en_map_words_i), .border_i(en_border_i), .abort_i(en_abort_i),
    .done_o(en_done_o), .refused_o(en_refused_o), .read_error_o(en_read_error_o), .write_error_o(en_write_error_o),
    .aborted_o(en_aborted_o), .clocks_o(en_clocks_o), .lines_o(en_lines_o), .writes_o(en_writes_o), .bad_o(en_bad_o),
    .ar_valid_o(ar_valid_o), .ar_ready_i(ar_ready_i), .ar_id_o(ar_id_o), .ar_addr_o(ar_addr_o), .ar_len_o(ar_len_o),
    .r_valid_i(r_valid_i), .r_ready_o(r_ready_o), .r_id_i(r_id_i), .r_data_i(r_data_i), .r_resp_i(r_resp_i),
    .aw_valid_o(aw_valid_o), .aw_ready_i(aw_ready_i), .aw_addr_o(aw_addr_o), .aw_len_o(aw_len_o),
    .w_valid_o(w_valid_o), .w_ready_i(w_ready_i), .w_data_o(w_data_o), .w_strb_o(w_strb_o), .w_last_o(w_last_o),
    .b_valid_i(b_valid_i), .b_ready_o(b_ready_o), .b_resp_i(b_resp_i)
  );
  assign ag_last_o = beat.last;
  assign ag_border_o = beat.border;
  assign ag_bad_o = beat.bad;
  assign ag_edge_x_o = beat.edge_x;
  assign ag_edge_y_o = beat.edge_y;
  assign ag_odd_o = beat.odd;
  assign ag_frac_x_o = beat.frac_x;
  assign ag_frac_y_o = beat.frac_y;
  assign ag_src_o = beat.src;
  assign ag_dst_o = beat.dst;
endmodule
