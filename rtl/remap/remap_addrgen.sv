// Address generator: for each pair of output pixels of a job, where it comes from and where it goes.
// README.md of this folder's parent defines the results bit by bit.
module remap_addrgen #(
  parameter bit WithRadial = 1'b1,  // without: such jobs are refused
  parameter bit WithProject = 1'b1
) (
  input  logic              clk_i,
  input  logic              rst_ni,        // asynchronous, active low
  input  logic              clear_i,       // abandons the job
  input  logic              job_valid_i,
  output logic              job_ready_o,   // idle
  input  remap_pkg::job_t   job_i,
  output logic              job_refused_o, // the job of the cycle before is not possible
  output logic              busy_o,
  input  logic              map_valid_i,   // entries, nodes or coefficients, as the mode needs
  output logic              map_ready_o,
  input  logic [31:0]       map_i,
  output logic              beat_valid_o,
  input  logic              beat_ready_i,
  output remap_pkg::beat_t  beat_o
);
  remap_pkg::job_t job;
  logic accept, possible, start;

  // What can be done. The step of a grid bounds the number of its nodes.
  logic [12:0] step, cells;
  logic size_ok, source_ok, grid_ok, radial_ok, mode_ok;
  assign step = 13'd1 << job_i.grid_log2;
  assign cells = ({job_i.pairs, 1'b0} + step - 13'd1) >> job_i.grid_log2;
  assign size_ok = job_i.pairs != '0 && job_i.pairs <= 12'd2048 && job_i.rows != '0 && job_i.rows <= 13'd4096;
  assign source_ok = job_i.src_width != '0 && job_i.src_width <= 13'd4096 && !job_i.src_width[0] &&
                     job_i.src_height != '0 && job_i.src_height <= 13'd4096 &&
                     job_i.src_pitch >= {1'b0, job_i.src_width[12:1]};
  assign grid_ok = job_i.mode != remap_pkg::ModeGrid ||
                   (job_i.grid_log2 >= 3'd2 && job_i.grid_log2 <= 3'd6 && cells < 13'd256);
  assign radial_ok = job_i.mode != remap_pkg::ModeRadial ||
                     (job_i.pieces != '0 && job_i.pieces <= 8'd128 && job_i.piece_log2 <= 5'd23);
  assign mode_ok = (job_i.mode != remap_pkg::ModeRadial || WithRadial) &&
                   (job_i.mode != remap_pkg::ModeProject || WithProject);
  assign possible = size_ok && source_ok && grid_ok && radial_ok && mode_ok;

  assign job_ready_o = !busy_o && !start && !clear_i;
  assign accept = job_valid_i && job_ready_o;
  always_ff @(posedge clk_i)
    if (accept) job <= job_i;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      start <= 1'b0;
      job_refused_o <= 1'b0;
    end else begin
      start <= accept && possible && !clear_i;
      job_refused_o <= accept && !possible;
    end

  logic is_table, is_grid, is_radial, is_project;
  assign is_table = job.mode == remap_pkg::ModeTable;
  assign is_grid = job.mode == remap_pkg::ModeGrid;
  assign is_radial = job.mode == remap_pkg::ModeRadial;
  assign is_project = job.mode == remap_pkg::ModeProject;

  // The linear forms, for all modes but the table.
  logic form_valid, form_ready;
  logic signed [remap_pkg::FormBits-1:0] form_a, form_b, form_c;
  remap_scan u_scan (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .start_i(start && !is_table), .job_i(job),
    .valid_o(form_valid), .ready_i(form_ready), .a_o(form_a), .b_o(form_b), .c_o(form_c)
  );

  // Grid: the forms' position plus an offset.
  logic off_valid, off_ready, grid_map_ready, grid_out;
  logic signed [27:0] off_x, off_y;
  logic signed [remap_pkg::FormBits:0] grid_x, grid_y;
  remap_grid u_grid (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .start_i(start && is_grid), .job_i(job),
    .map_valid_i(map_valid_i && is_grid), .map_ready_o(grid_map_ready), .map_i(map_i),
    .valid_o(off_valid), .ready_i(off_ready), .x_o(off_x), .y_o(off_y)
  );
  assign grid_x = $signed({form_a[35], form_a}) + $signed({{9{off_x[27]}}, off_x});
  assign grid_y = $signed({form_b[35], form_b}) + $signed({{9{off_y[27]}}, off_y});
  assign grid_out = (grid_x[36:29] != '0 && grid_x[36:29] != '1) || (grid_y[36:29] != '0 && grid_y[36:29] != '1);

  logic radial_map_ready, radial_in_ready, radial_valid, radial_ready, radial_out, radial_loaded;
  logic signed [remap_pkg::PosBits-1:0] radial_x, radial_y;
  generate
    if (WithRadial) begin : gen_radial
      remap_radial u_radial (
        .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .start_i(start && is_radial), .job_i(job),
        .map_valid_i(map_valid_i && is_radial), .map_ready_o(radial_map_ready), .map_i(map_i), .loaded_o(radial_loaded),
        .valid_i(form_valid && is_radial), .ready_o(radial_in_ready), .a_i(form_a), .b_i(form_b), .c_i(form_c),
        .valid_o(radial_valid), .ready_i(radial_ready), .x_o(radial_x), .y_o(radial_y), .out_o(radial_out)
      );
    end else begin : gen_no_radial
      assign {radial_map_ready, radial_loaded, radial_in_ready, radial_valid, radial_out} = 5'd0;
      assign radial_x = '0;
      assign radial_y = '0;
    end
  endgenerate

  logic project_in_ready, project_valid, project_ready, project_out;
  logic signed [remap_pkg::PosBits-1:0] project_x, project_y;
  generate
    if (WithProject) begin : gen_project
      remap_project u_project (
        .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i),
        .valid_i(form_valid && is_project), .ready_o(project_in_ready), .a_i(form_a), .b_i(form_b), .c_i(form_c),
        .valid_o(project_valid), .ready_i(project_ready), .x_o(project_x), .y_o(project_y), .out_o(project_out)
      );
    end else begin : gen_no_project
      assign {project_in_ready, project_valid, project_out} = 3'd0;
      assign project_x = '0;
      assign project_y = '0;
    end
  endgenerate

  // One of the four leads to the addresses.
  logic pos_valid, pos_ready, pos_out, table_open;
  logic signed [remap_pkg::PosBits-1:0] pos_x, pos_y;
  logic left_valid, left_ready;
  remap_pkg::beat_t clipped, placed;
  assign pos_valid = is_table ? map_valid_i && table_open
                   : is_grid ? form_valid && off_valid
                   : is_radial ? radial_valid : project_valid;
  assign pos_x = is_grid ? grid_x[remap_pkg::PosBits-1:0] : is_radial ? radial_x : project_x;
  assign pos_y = is_grid ? grid_y[remap_pkg::PosBits-1:0] : is_radial ? radial_y : project_y;
  assign pos_out = is_grid ? grid_out : is_radial ? radial_out : project_out;
  assign form_ready = is_grid ? pos_ready && off_valid : is_radial ? radial_in_ready : project_in_ready;
  assign off_ready = pos_ready && form_valid && is_grid;
  assign radial_ready = pos_ready && is_radial;
  assign project_ready = pos_ready && is_project;
  assign map_ready_o = is_table ? pos_ready && table_open : is_grid ? grid_map_ready : radial_map_ready;

  // The table's entries are counted on their way in: those of the next job are left alone.
  remap_count u_entries (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .start_i(start && is_table), .job_i(job),
    .step_i(map_valid_i && map_ready_o), .busy_o(table_open)
  );

  remap_clip u_clip (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .job_i(job),
    .valid_i(pos_valid), .ready_o(pos_ready), .table_i(is_table), .entry_i(map_i),
    .x_i(pos_x), .y_i(pos_y), .out_i(pos_out),
    .valid_o(left_valid), .ready_i(left_ready), .beat_o(clipped)
  );

  logic [29:0] dst;
  logic last;
  remap_place u_place (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .start_i(start), .job_i(job),
    .step_i(left_valid && left_ready), .busy_o(busy_o), .dst_o(dst), .last_o(last)
  );
  always_comb begin
    placed = clipped;
    placed.dst = dst;
    placed.last = last;
  end
  logic [1:0] held;
  remap_fifo #(.Width(remap_pkg::BeatBits), .LogDepth(1)) u_beats (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i),
    .valid_i(left_valid), .ready_o(left_ready), .data_i(placed),
    .valid_o(beat_valid_o), .ready_i(beat_ready_i), .data_o(beat_o), .count_o(held)
  );
  logic unused;
  assign unused = ^{held, radial_loaded, radial_ready, project_ready, form_c};
endmodule
