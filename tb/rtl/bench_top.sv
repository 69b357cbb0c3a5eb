// The address generator as its tests see it: a port for each field of the job, as C++ cannot name fields of a packed
// structure.
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
  output logic [29:0] ag_dst_o
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
