// Reads the words of a map in bursts of up to 64 bytes, ahead of the address generator by at most the buffer's size.
// A burst is asked for only when the buffer has room for all of it, so read data never have to wait.
module remap_map_reader (
  input  logic        clk_i,
  input  logic        rst_ni,     // asynchronous, active low
  input  logic        clear_i,    // only while nothing is under way
  input  logic        stop_i,     // no new bursts
  input  logic        start_i,
  input  logic [25:0] base_i,     // in units of 64 bytes
  input  logic [23:0] words_i,
  output logic        busy_o,     // bursts are under way
  output logic        ar_valid_o,
  input  logic        ar_ready_i,
  output logic [31:0] ar_addr_o,
  output logic [7:0]  ar_len_o,
  input  logic        r_valid_i,  // always taken
  input  logic [63:0] r_data_i,
  output logic        map_valid_o,
  input  logic        map_ready_i,
  output logic [31:0] map_o
);
  localparam logic [5:0] Depth = 6'd32;   // beats of 64 bits
  logic [25:0] line;
  logic [23:0] left;                       // beats not asked for, up to 2^23
  logic [5:0]  promised;                   // beats asked for and not yet taken out of the buffer
  logic [3:0]  length;
  logic        asks, takes;
  assign length = left < 24'd8 ? left[3:0] : 4'd8;
  assign asks = ar_valid_o && ar_ready_i;

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      ar_valid_o <= 1'b0;
      ar_addr_o <= '0;
      ar_len_o <= '0;
      line <= '0;
      left <= '0;
    end else if (clear_i) begin
      ar_valid_o <= 1'b0;
      left <= '0;
    end else if (start_i) begin
      line <= base_i;
      left <= {1'b0, words_i[23:1]} + {23'd0, words_i[0]};
    end else if (asks) begin
      ar_valid_o <= 1'b0;
    end else if (!ar_valid_o && !stop_i && left != '0 && promised <= Depth - 6'd8) begin
      ar_valid_o <= 1'b1;
      ar_addr_o <= {line, 6'd0};
      ar_len_o <= {4'd0, length} - 8'd1;
      line <= line + 1'b1;
      left <= left - {20'd0, length};
    end

  // Beats asked for, with those of an offer that is still standing.
  logic [5:0] asked, under_way;
  assign asked = asks ? ar_len_o[5:0] + 6'd1 : 6'd0;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      promised <= '0;
      under_way <= '0;
    end else if (clear_i) begin
      promised <= '0;
      under_way <= '0;
    end else begin
      promised <= promised + asked - {5'd0, takes};
      under_way <= under_way + asked - {5'd0, r_valid_i};
    end
  assign busy_o = ar_valid_o || under_way != '0;

  // Two words of each beat, the lower first.
  logic        beat_valid, space, high;
  logic [63:0] beat;
  logic [5:0]  held;
  remap_fifo #(.Width(64), .LogDepth(5)) u_beats (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .valid_i(r_valid_i), .ready_o(space), .data_i(r_data_i),
    .valid_o(beat_valid), .ready_i(takes), .data_o(beat), .count_o(held)
  );
  assign map_valid_o = beat_valid;
  assign map_o = high ? beat[63:32] : beat[31:0];
  assign takes = map_valid_o && map_ready_i && high;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) high <= 1'b0;
    else if (clear_i) high <= 1'b0;
    else if (map_valid_o && map_ready_i) high <= !high;
  logic unused;
  assign unused = ^{space, held, ar_len_o[7:6]};

`ifdef FORMAL
  `include "remap_map_reader_props.svh"
`endif
endmodule
