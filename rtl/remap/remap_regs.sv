// Registers of the remap engine (remap_regs_pkg) behind an AXI4-Lite slave: the job window, the queue of jobs, events,
// interrupt, and the counters of the job that ended last. README.md of this folder's parent has the table.
// A write takes effect at the clock edge at which its address and its data are taken, which is the same one.
module remap_regs #(
  parameter int unsigned QueueDepth = 4  // jobs that can wait: 2, 4 or 8
) (
  input  logic              clk_i,
  input  logic              rst_ni,         // asynchronous, active low
  output logic              irq_o,          // level: an event whose enable is set
  output logic              busy_o,         // an access or a job needs clocks
  input  logic              s_aw_valid_i,
  output logic              s_aw_ready_o,
  input  logic [9:0]        s_aw_addr_i,
  input  logic              s_w_valid_i,
  output logic              s_w_ready_o,
  input  logic [31:0]       s_w_data_i,
  input  logic [3:0]        s_w_strb_i,
  output logic              s_b_valid_o,
  input  logic              s_b_ready_i,
  output logic [1:0]        s_b_resp_o,
  input  logic              s_ar_valid_i,
  output logic              s_ar_ready_o,
  input  logic [9:0]        s_ar_addr_i,
  output logic              s_r_valid_o,
  input  logic              s_r_ready_i,
  output logic [31:0]       s_r_data_o,
  output logic [1:0]        s_r_resp_o,
  output logic              job_valid_o,
  input  logic              job_ready_i,
  output remap_pkg::job_t   job_o,
  output logic [25:0]       map_base_o,     // in units of 64 bytes
  output logic [23:0]       map_words_o,
  output logic [31:0]       border_o,
  output logic              abort_o,        // ends the job under way early
  input  logic              done_i,         // the job ended; the inputs below are final in the next clock
  input  logic              refused_i,
  input  logic              read_error_i,
  input  logic              write_error_i,
  input  logic              aborted_i,
  input  logic [31:0]       clocks_i,
  input  logic [31:0]       lines_i,
  input  logic [31:0]       writes_i,
  input  logic [31:0]       bad_i
);
  localparam int unsigned LogQueue = $clog2(QueueDepth);
  localparam int unsigned JobBits = 540;                         // of job_t
  localparam int unsigned EntryBits = JobBits + 26 + 24 + 32 + 8;
  localparam logic [1:0]  Okay = 2'b00, SlaveError = 2'b10;

  // The bus. One write and one read at a time; each is answered in the clock after it was taken.
  logic [7:0]   write_word, read_word;
  logic [255:0] present;
  logic [31:0]  lanes, data, read_data;
  logic         write, low_byte;
  assign present = remap_regs_pkg::PRESENT;
  assign write_word = s_aw_addr_i[9:2];
  assign read_word = s_ar_addr_i[9:2];
  assign write = s_aw_valid_i && s_w_valid_i && !s_b_valid_o;
  assign s_aw_ready_o = write;
  assign s_w_ready_o = write;
  assign s_ar_ready_o = !s_r_valid_o;
  assign lanes = {{8{s_w_strb_i[3]}}, {8{s_w_strb_i[2]}}, {8{s_w_strb_i[1]}}, {8{s_w_strb_i[0]}}};
  assign data = s_w_data_i & lanes;
  assign low_byte = write && s_w_strb_i[0];
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      {s_b_valid_o, s_r_valid_o} <= 2'b00;
      {s_b_resp_o, s_r_resp_o} <= 4'd0;
      s_r_data_o <= 32'd0;
    end else begin
      if (write) begin
        s_b_valid_o <= 1'b1;
        s_b_resp_o <= present[write_word] ? Okay : SlaveError;
      end else if (s_b_ready_i) begin
        s_b_valid_o <= 1'b0;
      end
      if (s_ar_valid_i && s_ar_ready_o) begin
        s_r_valid_o <= 1'b1;
        s_r_resp_o <= present[read_word] ? Okay : SlaveError;
        s_r_data_o <= read_data;
      end else if (s_r_ready_i) begin
        s_r_valid_o <= 1'b0;
      end
    end

  // The job window.
  logic [31:0] mode, size, src_base, src_pitch, src_size, dst_base, dst_pitch, map_base, map_words, border;
  logic [31:0] radius_limit, centre_x, centre_y, a0, a1, a2, b0, b1, b2, c0, c1, c2;
  function automatic logic [31:0] merged(input logic [31:0] old, input logic [31:0] writable);
    merged = (old & ~(lanes & writable)) | (data & writable);
  endfunction
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      {mode, size, src_base, src_pitch, src_size, dst_base, dst_pitch, map_base, map_words, border} <= 320'd0;
      {radius_limit, centre_x, centre_y, a0, a1, a2, b0, b1, b2, c0, c1, c2} <= 384'd0;
    end else if (write) begin
      case (write_word)
        remap_regs_pkg::MODE_WORD: mode <= merged(mode, remap_regs_pkg::MODE_WRITABLE);
        remap_regs_pkg::SIZE_WORD: size <= merged(size, remap_regs_pkg::SIZE_WRITABLE);
        remap_regs_pkg::SRC_BASE_WORD: src_base <= merged(src_base, remap_regs_pkg::SRC_BASE_WRITABLE);
        remap_regs_pkg::SRC_PITCH_WORD: src_pitch <= merged(src_pitch, remap_regs_pkg::SRC_PITCH_WRITABLE);
        remap_regs_pkg::SRC_SIZE_WORD: src_size <= merged(src_size, remap_regs_pkg::SRC_SIZE_WRITABLE);
        remap_regs_pkg::DST_BASE_WORD: dst_base <= merged(dst_base, remap_regs_pkg::DST_BASE_WRITABLE);
        remap_regs_pkg::DST_PITCH_WORD: dst_pitch <= merged(dst_pitch, remap_regs_pkg::DST_PITCH_WRITABLE);
        remap_regs_pkg::MAP_BASE_WORD: map_base <= merged(map_base, remap_regs_pkg::MAP_BASE_WRITABLE);
        remap_regs_pkg::MAP_WORDS_WORD: map_words <= merged(map_words, remap_regs_pkg::MAP_WORDS_WRITABLE);
        remap_regs_pkg::BORDER_WORD: border <= merged(border, remap_regs_pkg::BORDER_WRITABLE);
        remap_regs_pkg::RADIUS_LIMIT_WORD:
          radius_limit <= merged(radius_limit, remap_regs_pkg::RADIUS_LIMIT_WRITABLE);
        remap_regs_pkg::CENTRE_X_WORD: centre_x <= merged(centre_x, remap_regs_pkg::CENTRE_X_WRITABLE);
        remap_regs_pkg::CENTRE_Y_WORD: centre_y <= merged(centre_y, remap_regs_pkg::CENTRE_Y_WRITABLE);
        remap_regs_pkg::A0_WORD: a0 <= merged(a0, remap_regs_pkg::A0_WRITABLE);
        remap_regs_pkg::A1_WORD: a1 <= merged(a1, remap_regs_pkg::A1_WRITABLE);
        remap_regs_pkg::A2_WORD: a2 <= merged(a2, remap_regs_pkg::A2_WRITABLE);
        remap_regs_pkg::B0_WORD: b0 <= merged(b0, remap_regs_pkg::B0_WRITABLE);
        remap_regs_pkg::B1_WORD: b1 <= merged(b1, remap_regs_pkg::B1_WRITABLE);
        remap_regs_pkg::B2_WORD: b2 <= merged(b2, remap_regs_pkg::B2_WRITABLE);
        remap_regs_pkg::C0_WORD: c0 <= merged(c0, remap_regs_pkg::C0_WRITABLE);
        remap_regs_pkg::C1_WORD: c1 <= merged(c1, remap_regs_pkg::C1_WRITABLE);
        remap_regs_pkg::C2_WORD: c2 <= merged(c2, remap_regs_pkg::C2_WRITABLE);
        default: ;
      endcase
    end

  // The queue. Its entries have the fields in the order of job_t.
  logic                 submit, room, waiting, take, enable;
  logic [EntryBits-1:0] entry, front;
  logic [LogQueue:0]    count;
  logic [7:0]           next_tag;
  assign entry = {
    data[remap_regs_pkg::SUBMIT_TAG_LSB +: remap_regs_pkg::SUBMIT_TAG_BITS], border, map_words[23:0], map_base[31:6],
    mode[remap_regs_pkg::MODE_MODE_LSB +: remap_regs_pkg::MODE_MODE_BITS],
    mode[remap_regs_pkg::MODE_BILINEAR_LSB],
    size[remap_regs_pkg::SIZE_PAIRS_LSB +: remap_regs_pkg::SIZE_PAIRS_BITS],
    size[remap_regs_pkg::SIZE_ROWS_LSB +: remap_regs_pkg::SIZE_ROWS_BITS],
    src_base[31:2], src_pitch[14:2],
    src_size[remap_regs_pkg::SRC_SIZE_WIDTH_LSB +: remap_regs_pkg::SRC_SIZE_WIDTH_BITS],
    src_size[remap_regs_pkg::SRC_SIZE_HEIGHT_LSB +: remap_regs_pkg::SRC_SIZE_HEIGHT_BITS],
    dst_base[31:2], dst_pitch[14:2],
    mode[remap_regs_pkg::MODE_GRID_LOG2_LSB +: remap_regs_pkg::MODE_GRID_LOG2_BITS],
    mode[remap_regs_pkg::MODE_PIECES_LSB +: remap_regs_pkg::MODE_PIECES_BITS],
    mode[remap_regs_pkg::MODE_PIECE_LOG2_LSB +: remap_regs_pkg::MODE_PIECE_LOG2_BITS],
    radius_limit, centre_x, centre_y, a0, a1, a2, b0, b1, b2, c0, c1, c2
  };
  assign submit = low_byte && write_word == remap_regs_pkg::SUBMIT_WORD;
  assign abort_o = low_byte && write_word == remap_regs_pkg::CTRL_WORD && data[remap_regs_pkg::CTRL_ABORT_LSB];
  remap_fifo #(.Width(EntryBits), .LogDepth(LogQueue)) u_queue (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(abort_o),
    .valid_i(submit), .ready_o(room), .data_i(entry),
    .valid_o(waiting), .ready_i(take), .data_o(front), .count_o(count)
  );
  assign job_valid_o = enable && waiting && !abort_o;  // a job that is aborted waiting is dropped, not taken
  assign take = job_valid_o && job_ready_i;
  assign {next_tag, border_o, map_words_o, map_base_o, job_o} = front;

  // Control and events. An event that comes in the clock in which it is cleared stays.
  logic       running, ended;
  logic [6:0] events, enables, happened, result, last_result, cleared;
  logic [7:0] tag, last_tag;
  logic [15:0] jobs;
  logic [31:0] clocks, lines, writes, bad;
  always_comb begin
    result = 7'd0;
    result[remap_regs_pkg::EVENTS_REFUSED_LSB] = refused_i;
    result[remap_regs_pkg::EVENTS_READ_ERROR_LSB] = read_error_i;
    result[remap_regs_pkg::EVENTS_WRITE_ERROR_LSB] = write_error_i;
    result[remap_regs_pkg::EVENTS_ABORTED_LSB] = aborted_i;
    result[remap_regs_pkg::EVENTS_DONE_LSB] = result == 7'd0;
    happened = ended ? result : 7'd0;
    happened[remap_regs_pkg::EVENTS_OVERFLOW_LSB] = submit && !room;
    happened[remap_regs_pkg::EVENTS_DROPPED_LSB] = abort_o && waiting;
  end
  assign cleared = low_byte && write_word == remap_regs_pkg::EVENTS_WORD ? data[6:0] : 7'd0;
  assign irq_o = |(events & enables);
  assign busy_o = running || job_valid_o || s_b_valid_o || s_r_valid_o || s_aw_valid_i || s_w_valid_i || s_ar_valid_i;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      {enable, running, ended} <= 3'd0;
      {events, enables} <= 14'd0;
      {tag, last_tag, last_result, jobs} <= 39'd0;
      {clocks, lines, writes, bad} <= 128'd0;
    end else begin
      ended <= done_i;
      events <= (events & ~cleared) | happened;
      if (low_byte && write_word == remap_regs_pkg::CTRL_WORD) enable <= data[remap_regs_pkg::CTRL_ENABLE_LSB];
      if (low_byte && write_word == remap_regs_pkg::ENABLES_WORD) enables <= data[6:0];
      if (take) begin
        running <= 1'b1;
        tag <= next_tag;
      end else if (ended) begin
        running <= 1'b0;
      end
      if (ended) begin
        {last_tag, last_result} <= {tag, result};
        jobs <= jobs + 16'd1;
        {clocks, lines, writes, bad} <= {clocks_i, lines_i, writes_i, bad_i};
      end
    end

  // What a read answers.
  logic [31:0] status, last;
  assign last = ({24'd0, last_tag} << remap_regs_pkg::ENDED_TAG_LSB) |
                ({25'd0, last_result} << remap_regs_pkg::ENDED_EVENTS_LSB) |
                ({16'd0, jobs} << remap_regs_pkg::ENDED_COUNT_LSB);
  assign status = (running ? 32'd1 << remap_regs_pkg::STATUS_BUSY_LSB : 32'd0) |
                  ({{(31-LogQueue){1'b0}}, count} << remap_regs_pkg::STATUS_QUEUED_LSB) |
                  (room ? 32'd0 : 32'd1 << remap_regs_pkg::STATUS_FULL_LSB);
  always_comb
    case (read_word)
      remap_regs_pkg::ID_WORD: read_data = remap_regs_pkg::ID_RESET;
      remap_regs_pkg::CTRL_WORD: read_data = enable ? 32'd1 << remap_regs_pkg::CTRL_ENABLE_LSB : 32'd0;
      remap_regs_pkg::STATUS_WORD: read_data = status;
      remap_regs_pkg::EVENTS_WORD: read_data = {25'd0, events};
      remap_regs_pkg::ENABLES_WORD: read_data = {25'd0, enables};
      remap_regs_pkg::ENDED_WORD: read_data = last;
      remap_regs_pkg::CLOCKS_WORD: read_data = clocks;
      remap_regs_pkg::LINES_WORD: read_data = lines;
      remap_regs_pkg::WRITES_WORD: read_data = writes;
      remap_regs_pkg::BAD_WORD: read_data = bad;
      remap_regs_pkg::MODE_WORD: read_data = mode;
      remap_regs_pkg::SIZE_WORD: read_data = size;
      remap_regs_pkg::SRC_BASE_WORD: read_data = src_base;
      remap_regs_pkg::SRC_PITCH_WORD: read_data = src_pitch;
      remap_regs_pkg::SRC_SIZE_WORD: read_data = src_size;
      remap_regs_pkg::DST_BASE_WORD: read_data = dst_base;
      remap_regs_pkg::DST_PITCH_WORD: read_data = dst_pitch;
      remap_regs_pkg::MAP_BASE_WORD: read_data = map_base;
      remap_regs_pkg::MAP_WORDS_WORD: read_data = map_words;
      remap_regs_pkg::BORDER_WORD: read_data = border;
      remap_regs_pkg::RADIUS_LIMIT_WORD: read_data = radius_limit;
      remap_regs_pkg::CENTRE_X_WORD: read_data = centre_x;
      remap_regs_pkg::CENTRE_Y_WORD: read_data = centre_y;
      remap_regs_pkg::A0_WORD: read_data = a0;
      remap_regs_pkg::A1_WORD: read_data = a1;
      remap_regs_pkg::A2_WORD: read_data = a2;
      remap_regs_pkg::B0_WORD: read_data = b0;
      remap_regs_pkg::B1_WORD: read_data = b1;
      remap_regs_pkg::B2_WORD: read_data = b2;
      remap_regs_pkg::C0_WORD: read_data = c0;
      remap_regs_pkg::C1_WORD: read_data = c1;
      remap_regs_pkg::C2_WORD: read_data = c2;
      default: read_data = 32'd0;  // SUBMIT, and what is no register
    endcase
  logic unused;
  assign unused = ^{s_aw_addr_i[1:0], s_ar_addr_i[1:0]};

`ifdef FORMAL
  `include "remap_regs_props.svh"
`endif
endmodule
