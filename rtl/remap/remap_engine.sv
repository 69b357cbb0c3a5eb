// Remap engine: makes a frame of a job. Reads map and source, and writes the result, as a master of an AXI4 bus with
// 64 bits. Reads of maps have the identifier 0, those of sources 1; each expects its answers in order.
module remap_engine #(
  parameter int unsigned LogLines = 8,  // of the source cache, 32 bytes each: 3 to 12
  parameter int unsigned Prefetch = 8   // lines of the source under way at most: 1 to 8
) (
  input  logic              clk_i,
  input  logic              rst_ni,         // asynchronous, active low
  input  logic              job_valid_i,
  output logic              job_ready_o,
  input  remap_pkg::job_t   job_i,
  input  logic [25:0]       map_base_i,     // in units of 64 bytes
  input  logic [23:0]       map_words_i,
  input  logic [31:0]       border_i,
  input  logic              abort_i,        // ends the job early
  output logic              done_o,         // for one clock: the job ended, and nothing of it is under way
  output logic              refused_o,      // with done_o: the job is not possible
  output logic              read_error_o,   // with done_o: a read was answered with an error
  output logic              write_error_o,  // with done_o: a write was
  output logic              aborted_o,      // with done_o: abort_i came before the end
  output logic [31:0]       clocks_o,       // of this job, or of the last one
  output logic [31:0]       lines_o,        // of the source, read by it
  output logic [31:0]       writes_o,       // bursts written by it
  output logic [31:0]       bad_o,          // entries of its table that are no addresses
  output logic              ar_valid_o,
  input  logic              ar_ready_i,
  output logic              ar_id_o,
  output logic [31:0]       ar_addr_o,
  output logic [7:0]        ar_len_o,
  input  logic              r_valid_i,
  output logic              r_ready_o,
  input  logic              r_id_i,
  input  logic [63:0]       r_data_i,
  input  logic [1:0]        r_resp_i,
  output logic              aw_valid_o,
  input  logic              aw_ready_i,
  output logic [31:0]       aw_addr_o,
  output logic [7:0]        aw_len_o,
  output logic              w_valid_o,
  input  logic              w_ready_i,
  output logic [63:0]       w_data_o,
  output logic [7:0]        w_strb_o,
  output logic              w_last_o,
  input  logic              b_valid_i,
  output logic              b_ready_o,
  input  logic [1:0]        b_resp_i
);
  typedef enum logic [1:0] {Idle, Begin, Run, Drain} state_e;
  state_e state;
  logic accept, refused, clear, stop, failed, finished, quiet;
  logic ag_ready, ag_busy;
  logic bilinear;
  logic [12:0] src_pitch;
  logic [31:0] border;
  logic [25:0] map_base;
  logic [23:0] map_words;

  assign job_ready_o = state == Idle && ag_ready;
  assign accept = job_valid_i && job_ready_o;
  assign r_ready_o = 1'b1;
  assign b_ready_o = 1'b1;
  assign failed = (r_valid_i && r_resp_i[1]) || (b_valid_i && b_resp_i[1]);

  // Parts, from right to left of the picture: map, addresses, source, blending, writes.
  logic map_busy, map_ar_valid, map_ar_ready, map_valid, map_ready;
  logic [31:0] map_ar_addr, map_word;
  logic [7:0]  map_ar_len;
  remap_map_reader u_map (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear), .stop_i(stop), .start_i(state == Begin && !refused),
    .base_i(map_base), .words_i(map_words), .busy_o(map_busy),
    .ar_valid_o(map_ar_valid), .ar_ready_i(map_ar_ready), .ar_addr_o(map_ar_addr), .ar_len_o(map_ar_len),
    .r_valid_i(r_valid_i && !r_id_i), .r_data_i(r_data_i),
    .map_valid_o(map_valid), .map_ready_i(map_ready), .map_o(map_word)
  );

  logic beat_valid, beat_ready;
  remap_pkg::beat_t beat;
  remap_addrgen u_addrgen (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear),
    .job_valid_i(accept), .job_ready_o(ag_ready), .job_i(job_i), .job_refused_o(refused), .busy_o(ag_busy),
    .map_valid_i(map_valid), .map_ready_o(map_ready), .map_i(map_word),
    .beat_valid_o(beat_valid), .beat_ready_i(beat_ready), .beat_o(beat)
  );

  // Accesses of a beat: one, or four for interpolation.
  logic [1:0]  which;
  logic        final_access, access_ready;
  logic [29:0] right, below;
  assign final_access = !bilinear || beat.border || which == 2'd3;
  assign beat_ready = access_ready && final_access;
  assign right = which[0] && !beat.edge_x ? 30'd1 : 30'd0;
  assign below = which[1] && !beat.edge_y ? {17'd0, src_pitch} : 30'd0;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) which <= '0;
    else if (clear) which <= '0;
    else if (beat_valid && access_ready) which <= final_access ? 2'd0 : which + 2'd1;

  logic src_busy, src_ar_valid, src_ar_ready, word_valid, word_ready;
  logic [31:0] src_ar_addr, word;
  logic [87:0] side;
  remap_source #(.LogLines(LogLines), .Prefetch(Prefetch)) u_source (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear), .stop_i(stop),
    .valid_i(beat_valid), .ready_o(access_ready), .none_i(beat.border), .addr_i(beat.src + right + below),
    .side_i({3'd0, which, final_access, beat}), .busy_o(src_busy),
    .ar_valid_o(src_ar_valid), .ar_ready_i(src_ar_ready), .ar_addr_o(src_ar_addr),
    .r_valid_i(r_valid_i && r_id_i), .r_data_i(r_data_i),
    .valid_o(word_valid), .ready_i(word_ready), .word_o(word), .side_o(side)
  );

  logic out_valid, out_ready, out_last, final_word;
  logic [31:0] out_word;
  logic [29:0] out_dst;
  logic [1:0]  which_word;
  remap_pkg::beat_t word_beat;
  assign {which_word, final_word, word_beat} = side[84:0];
  remap_blend u_blend (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear), .bilinear_i(bilinear), .border_i(border),
    .valid_i(word_valid), .ready_o(word_ready), .word_i(word), .which_i(which_word), .final_i(final_word),
    .beat_i(word_beat), .valid_o(out_valid), .ready_i(out_ready), .word_o(out_word), .dst_o(out_dst),
    .last_o(out_last)
  );

  logic write_busy;
  remap_packer u_packer (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear), .stop_i(stop),
    .valid_i(out_valid), .ready_o(out_ready), .word_i(out_word), .dst_i(out_dst), .last_i(out_last),
    .busy_o(write_busy), .done_o(finished),
    .aw_valid_o(aw_valid_o), .aw_ready_i(aw_ready_i), .aw_addr_o(aw_addr_o), .aw_len_o(aw_len_o),
    .w_valid_o(w_valid_o), .w_ready_i(w_ready_i), .w_data_o(w_data_o), .w_strb_o(w_strb_o), .w_last_o(w_last_o),
    .b_valid_i(b_valid_i)
  );

  // One of the two readers asks; who has begun to ask goes on until it is heard.
  logic held, held_source, from_source;
  assign from_source = held ? held_source : src_ar_valid;
  assign ar_valid_o = from_source ? src_ar_valid : map_ar_valid;
  assign ar_id_o = from_source;
  assign ar_addr_o = from_source ? src_ar_addr : map_ar_addr;
  assign ar_len_o = from_source ? 8'd3 : map_ar_len;
  assign src_ar_ready = ar_ready_i && from_source;
  assign map_ar_ready = ar_ready_i && !from_source;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      held <= 1'b0;
      held_source <= 1'b0;
    end else begin
      held <= ar_valid_o && !ar_ready_i;
      held_source <= from_source;
    end

  // The job's course. Whatever ends it, nothing new is asked for, what is under way comes in, then all is cleared.
  assign quiet = !map_busy && !src_busy && !write_busy;
  assign stop = state == Drain;
  assign clear = stop && quiet;
  assign done_o = clear;
  always_ff @(posedge clk_i)
    if (accept) begin
      bilinear <= job_i.bilinear;
      src_pitch <= job_i.src_pitch;
      border <= border_i;
      map_base <= map_base_i;
      map_words <= map_words_i;
    end
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      state <= Idle;
      {refused_o, read_error_o, write_error_o, aborted_o} <= 4'd0;
      {clocks_o, lines_o, writes_o, bad_o} <= 128'd0;
    end else begin
      if (accept) begin
        state <= Begin;
        {refused_o, read_error_o, write_error_o, aborted_o} <= 4'd0;
        {clocks_o, lines_o, writes_o, bad_o} <= 128'd0;
      end else if (state == Begin) begin
        state <= refused || abort_i ? Drain : Run;
        refused_o <= refused;
        aborted_o <= abort_i && !refused;
      end else if (state == Run && (failed || abort_i || finished)) begin
        state <= Drain;
        aborted_o <= abort_i && !finished;
      end else if (clear) begin
        state <= Idle;
      end
      if (state != Idle) begin
        clocks_o <= clocks_o + 32'd1;
        if (r_valid_i && r_resp_i[1]) read_error_o <= 1'b1;
        if (b_valid_i && b_resp_i[1]) write_error_o <= 1'b1;
        if (src_ar_valid && src_ar_ready) lines_o <= lines_o + 32'd1;
        if (b_valid_i) writes_o <= writes_o + 32'd1;
        if (beat_valid && beat_ready && beat.bad) bad_o <= bad_o + 32'd1;
      end
    end
  logic unused;
  assign unused = ^{ag_busy, side[87:85], r_resp_i[0], b_resp_i[0]};
endmodule
