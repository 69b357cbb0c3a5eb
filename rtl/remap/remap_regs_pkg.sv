// Registers of the remap engine. Printed by `platform_text remap_regs_pkg.sv` from
// model/engine/core/engine_registers.h; do not edit. WORD: number of the register's word; WRITABLE: bits that keep
// what is written.
package remap_regs_pkg;
  // Bit n: word n is a register.
  localparam logic [255:0] PRESENT = 256'h00000000_00000000_00000000_00000000_00000000_00000000_0000003F_FFFF0F7F;
  // 0x00 ID: identification
  localparam logic [7:0] ID_WORD = 8'd0;
  localparam logic [31:0] ID_RESET = 32'h52454D31;
  // 0x04 CTRL: control
  localparam logic [7:0] CTRL_WORD = 8'd1;
  localparam logic [31:0] CTRL_WRITABLE = 32'h00000001;
  localparam int unsigned CTRL_ENABLE_LSB = 0, CTRL_ENABLE_BITS = 1;
  localparam int unsigned CTRL_ABORT_LSB = 1, CTRL_ABORT_BITS = 1;
  // 0x08 STATUS: status
  localparam logic [7:0] STATUS_WORD = 8'd2;
  localparam int unsigned STATUS_BUSY_LSB = 0, STATUS_BUSY_BITS = 1;
  localparam int unsigned STATUS_QUEUED_LSB = 4, STATUS_QUEUED_BITS = 4;
  localparam int unsigned STATUS_FULL_LSB = 8, STATUS_FULL_BITS = 1;
  // 0x0C EVENTS: what has happened; 1 clears
  localparam logic [7:0] EVENTS_WORD = 8'd3;
  localparam int unsigned EVENTS_DONE_LSB = 0, EVENTS_DONE_BITS = 1;
  localparam int unsigned EVENTS_REFUSED_LSB = 1, EVENTS_REFUSED_BITS = 1;
  localparam int unsigned EVENTS_READ_ERROR_LSB = 2, EVENTS_READ_ERROR_BITS = 1;
  localparam int unsigned EVENTS_WRITE_ERROR_LSB = 3, EVENTS_WRITE_ERROR_BITS = 1;
  localparam int unsigned EVENTS_ABORTED_LSB = 4, EVENTS_ABORTED_BITS = 1;
  localparam int unsigned EVENTS_OVERFLOW_LSB = 5, EVENTS_OVERFLOW_BITS = 1;
  localparam int unsigned EVENTS_DROPPED_LSB = 6, EVENTS_DROPPED_BITS = 1;
  // 0x10 ENABLES: events that hold the interrupt line high
  localparam logic [7:0] ENABLES_WORD = 8'd4;
  localparam logic [31:0] ENABLES_WRITABLE = 32'h0000007F;
  localparam int unsigned ENABLES_DONE_LSB = 0, ENABLES_DONE_BITS = 1;
  localparam int unsigned ENABLES_REFUSED_LSB = 1, ENABLES_REFUSED_BITS = 1;
  localparam int unsigned ENABLES_READ_ERROR_LSB = 2, ENABLES_READ_ERROR_BITS = 1;
  localparam int unsigned ENABLES_WRITE_ERROR_LSB = 3, ENABLES_WRITE_ERROR_BITS = 1;
  localparam int unsigned ENABLES_ABORTED_LSB = 4, ENABLES_ABORTED_BITS = 1;
  localparam int unsigned ENABLES_OVERFLOW_LSB = 5, ENABLES_OVERFLOW_BITS = 1;
  localparam int unsigned ENABLES_DROPPED_LSB = 6, ENABLES_DROPPED_BITS = 1;
  // 0x14 SUBMIT: puts the job of MODE to C2 into the queue
  localparam logic [7:0] SUBMIT_WORD = 8'd5;
  localparam int unsigned SUBMIT_TAG_LSB = 0, SUBMIT_TAG_BITS = 8;
  // 0x18 ENDED: the job that ended last
  localparam logic [7:0] ENDED_WORD = 8'd6;
  localparam int unsigned ENDED_TAG_LSB = 0, ENDED_TAG_BITS = 8;
  localparam int unsigned ENDED_EVENTS_LSB = 8, ENDED_EVENTS_BITS = 8;
  localparam int unsigned ENDED_COUNT_LSB = 16, ENDED_COUNT_BITS = 16;
  // 0x20 CLOCKS: clocks that the job took which ended last
  localparam logic [7:0] CLOCKS_WORD = 8'd8;
  // 0x24 LINES: lines of the source that it read
  localparam logic [7:0] LINES_WORD = 8'd9;
  // 0x28 WRITES: bursts that it wrote
  localparam logic [7:0] WRITES_WORD = 8'd10;
  // 0x2C BAD: entries of its table that are no addresses
  localparam logic [7:0] BAD_WORD = 8'd11;
  // 0x40 MODE: how positions follow
  localparam logic [7:0] MODE_WORD = 8'd16;
  localparam logic [31:0] MODE_WRITABLE = 32'h1FFF0707;
  localparam int unsigned MODE_MODE_LSB = 0, MODE_MODE_BITS = 2;
  localparam int unsigned MODE_BILINEAR_LSB = 2, MODE_BILINEAR_BITS = 1;
  localparam int unsigned MODE_GRID_LOG2_LSB = 8, MODE_GRID_LOG2_BITS = 3;
  localparam int unsigned MODE_PIECES_LSB = 16, MODE_PIECES_BITS = 8;
  localparam int unsigned MODE_PIECE_LOG2_LSB = 24, MODE_PIECE_LOG2_BITS = 5;
  // 0x44 SIZE: the result's size
  localparam logic [7:0] SIZE_WORD = 8'd17;
  localparam logic [31:0] SIZE_WRITABLE = 32'h1FFF0FFF;
  localparam int unsigned SIZE_PAIRS_LSB = 0, SIZE_PAIRS_BITS = 12;
  localparam int unsigned SIZE_ROWS_LSB = 16, SIZE_ROWS_BITS = 13;
  // 0x48 SRC_BASE: first byte of the source
  localparam logic [7:0] SRC_BASE_WORD = 8'd18;
  localparam logic [31:0] SRC_BASE_WRITABLE = 32'hFFFFFFFC;
  localparam int unsigned SRC_BASE_BYTES_LSB = 2, SRC_BASE_BYTES_BITS = 30;
  // 0x4C SRC_PITCH: from row to row of the source
  localparam logic [7:0] SRC_PITCH_WORD = 8'd19;
  localparam logic [31:0] SRC_PITCH_WRITABLE = 32'h00007FFC;
  localparam int unsigned SRC_PITCH_BYTES_LSB = 2, SRC_PITCH_BYTES_BITS = 13;
  // 0x50 SRC_SIZE: the source's size
  localparam logic [7:0] SRC_SIZE_WORD = 8'd20;
  localparam logic [31:0] SRC_SIZE_WRITABLE = 32'h1FFF1FFF;
  localparam int unsigned SRC_SIZE_WIDTH_LSB = 0, SRC_SIZE_WIDTH_BITS = 13;
  localparam int unsigned SRC_SIZE_HEIGHT_LSB = 16, SRC_SIZE_HEIGHT_BITS = 13;
  // 0x54 DST_BASE: first byte of the result
  localparam logic [7:0] DST_BASE_WORD = 8'd21;
  localparam logic [31:0] DST_BASE_WRITABLE = 32'hFFFFFFFC;
  localparam int unsigned DST_BASE_BYTES_LSB = 2, DST_BASE_BYTES_BITS = 30;
  // 0x58 DST_PITCH: from row to row of the result
  localparam logic [7:0] DST_PITCH_WORD = 8'd22;
  localparam logic [31:0] DST_PITCH_WRITABLE = 32'h00007FFC;
  localparam int unsigned DST_PITCH_BYTES_LSB = 2, DST_PITCH_BYTES_BITS = 13;
  // 0x5C MAP_BASE: first byte of the map
  localparam logic [7:0] MAP_BASE_WORD = 8'd23;
  localparam logic [31:0] MAP_BASE_WRITABLE = 32'hFFFFFFC0;
  localparam int unsigned MAP_BASE_BYTES_LSB = 6, MAP_BASE_BYTES_BITS = 26;
  // 0x60 MAP_WORDS: length of the map
  localparam logic [7:0] MAP_WORDS_WORD = 8'd24;
  localparam logic [31:0] MAP_WORDS_WRITABLE = 32'h00FFFFFF;
  localparam int unsigned MAP_WORDS_WORDS_LSB = 0, MAP_WORDS_WORDS_BITS = 24;
  // 0x64 BORDER: the word of a pair without a source
  localparam logic [7:0] BORDER_WORD = 8'd25;
  localparam logic [31:0] BORDER_WRITABLE = 32'hFFFFFFFF;
  // 0x68 RADIUS_LIMIT: largest visible square radius, Q8
  localparam logic [7:0] RADIUS_LIMIT_WORD = 8'd26;
  localparam logic [31:0] RADIUS_LIMIT_WRITABLE = 32'hFFFFFFFF;
  // 0x6C CENTRE_X: centre in the source, pixels, Q16
  localparam logic [7:0] CENTRE_X_WORD = 8'd27;
  localparam logic [31:0] CENTRE_X_WRITABLE = 32'hFFFFFFFF;
  // 0x70 CENTRE_Y: centre in the source, rows, Q16
  localparam logic [7:0] CENTRE_Y_WORD = 8'd28;
  localparam logic [31:0] CENTRE_Y_WRITABLE = 32'hFFFFFFFF;
  // 0x74 A0: linear form A: first value
  localparam logic [7:0] A0_WORD = 8'd29;
  localparam logic [31:0] A0_WRITABLE = 32'hFFFFFFFF;
  // 0x78 A1: linear form A: step of a pair
  localparam logic [7:0] A1_WORD = 8'd30;
  localparam logic [31:0] A1_WRITABLE = 32'hFFFFFFFF;
  // 0x7C A2: linear form A: step of a row
  localparam logic [7:0] A2_WORD = 8'd31;
  localparam logic [31:0] A2_WRITABLE = 32'hFFFFFFFF;
  // 0x80 B0: linear form B: first value
  localparam logic [7:0] B0_WORD = 8'd32;
  localparam logic [31:0] B0_WRITABLE = 32'hFFFFFFFF;
  // 0x84 B1: linear form B: step of a pair
  localparam logic [7:0] B1_WORD = 8'd33;
  localparam logic [31:0] B1_WRITABLE = 32'hFFFFFFFF;
  // 0x88 B2: linear form B: step of a row
  localparam logic [7:0] B2_WORD = 8'd34;
  localparam logic [31:0] B2_WRITABLE = 32'hFFFFFFFF;
  // 0x8C C0: linear form C: first value
  localparam logic [7:0] C0_WORD = 8'd35;
  localparam logic [31:0] C0_WRITABLE = 32'hFFFFFFFF;
  // 0x90 C1: linear form C: step of a pair
  localparam logic [7:0] C1_WORD = 8'd36;
  localparam logic [31:0] C1_WRITABLE = 32'hFFFFFFFF;
  // 0x94 C2: linear form C: step of a row
  localparam logic [7:0] C2_WORD = 8'd37;
  localparam logic [31:0] C2_WRITABLE = 32'hFFFFFFFF;
endpackage
