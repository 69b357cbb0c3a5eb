// Combines the words of the result to bursts within 64 bytes, and writes them. Up to four bursts are under way.
module remap_packer (
  input  logic        clk_i,
  input  logic        rst_ni,     // asynchronous, active low
  input  logic        clear_i,    // only while nothing is under way
  input  logic        stop_i,     // no new bursts
  input  logic        valid_i,
  output logic        ready_o,
  input  logic [31:0] word_i,
  input  logic [29:0] dst_i,      // word address
  input  logic        last_i,     // of the job
  output logic        busy_o,     // bursts are under way
  output logic        done_o,     // the last word of the job is in memory
  output logic        aw_valid_o,
  input  logic        aw_ready_i,
  output logic [31:0] aw_addr_o,
  output logic [7:0]  aw_len_o,
  output logic        w_valid_o,
  input  logic        w_ready_i,
  output logic [63:0] w_data_o,
  output logic [7:0]  w_strb_o,
  output logic        w_last_o,
  input  logic        b_valid_i   // always taken
);
  // What is collected.
  logic [511:0] gather;
  logic [15:0]  mask;
  logic [25:0]  line;
  logic         full, ended, same, take, hand_over;
  logic [8:0]   at;
  assign same = mask == '0 || line == dst_i[29:4];
  assign full = mask != '0 && (ended || mask[15] || (valid_i && !same));
  assign ready_o = !full;
  assign take = valid_i && ready_o;
  assign at = {dst_i[3:0], 5'd0};

  // What is sent.
  logic         sending, aw_done;
  logic [511:0] out;
  logic [15:0]  out_mask;
  logic [2:0]   beat, last_beat, first_beat, final_beat;
  logic [2:0]   under_way;
  logic         sent;
  assign hand_over = full && !sending && !stop_i && under_way != 3'd4;

  always_ff @(posedge clk_i)
    if (take) gather[at+:32] <= word_i;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      mask <= '0;
      line <= '0;
      ended <= 1'b0;
    end else if (clear_i) begin
      mask <= '0;
      ended <= 1'b0;
    end else if (hand_over) begin
      mask <= '0;
    end else if (take) begin
      mask <= mask | (16'd1 << dst_i[3:0]);
      line <= dst_i[29:4];
      ended <= last_i;
    end

  // First and last beat with a word.
  always_comb begin
    first_beat = 3'd0;
    final_beat = 3'd0;
    for (int k = 7; k >= 0; k = k - 1)
      if (mask[2*k+:2] != 2'b00) first_beat = k[2:0];
    for (int k = 0; k < 8; k = k + 1)
      if (mask[2*k+:2] != 2'b00) final_beat = k[2:0];
  end

  assign aw_valid_o = sending && !aw_done;
  assign w_valid_o = sending && !sent;
  assign w_data_o = out[{beat, 6'd0}+:64];
  assign w_strb_o = {{4{out_mask[{beat, 1'b1}]}}, {4{out_mask[{beat, 1'b0}]}}};
  assign w_last_o = beat == last_beat;
  always_ff @(posedge clk_i)
    if (hand_over) begin
      out <= gather;
      out_mask <= mask;
    end
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      sending <= 1'b0;
      aw_done <= 1'b0;
      sent <= 1'b0;
      beat <= '0;
      last_beat <= '0;
      aw_addr_o <= '0;
      aw_len_o <= '0;
      under_way <= '0;
    end else if (clear_i) begin
      sending <= 1'b0;
      under_way <= '0;
    end else begin
      if (hand_over) begin
        sending <= 1'b1;
        aw_done <= 1'b0;
        sent <= 1'b0;
        beat <= first_beat;
        last_beat <= final_beat;
        aw_addr_o <= {line, first_beat, 3'd0};
        aw_len_o <= {5'd0, final_beat} - {5'd0, first_beat};
      end else if (sending) begin
        if (aw_valid_o && aw_ready_i) aw_done <= 1'b1;
        if (w_valid_o && w_ready_i) begin
          beat <= beat + 1'b1;
          if (w_last_o) sent <= 1'b1;
        end
        if ((aw_done || aw_ready_i) && (sent || (w_ready_i && w_last_o))) sending <= 1'b0;
      end
      under_way <= under_way + {2'd0, hand_over} - {2'd0, b_valid_i};
    end
  assign busy_o = under_way != '0;
  assign done_o = ended && mask == '0 && under_way == '0;

`ifdef FORMAL
  `include "remap_packer_props.svh"
`endif
endmodule
