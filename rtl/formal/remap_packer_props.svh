  `include "remap_formal.svh"
  // The memory answers a burst after its address and its last beat, and each once.
  logic [2:0] f_answerable = '0;
  logic f_whole;
  assign f_whole = sending && (aw_done || aw_ready_i) && (sent || (w_ready_i && w_last_o));
  always_ff @(posedge clk_i)
    if (!rst_ni || clear_i) f_answerable <= '0;
    else f_answerable <= f_answerable + {2'd0, f_whole} - {2'd0, b_valid_i};
  always_comb begin
    if (f_answerable == '0) assume (!b_valid_i);
    if (busy_o) assume (!clear_i);
  end
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      four_at_most: assert (under_way <= 3'd4);
      f_count: assert ({1'b0, under_way} == {1'b0, f_answerable} + {3'd0, sending});
      if ($past(rst_ni && aw_valid_o && !aw_ready_i)) begin
        address_stays: assert (aw_valid_o);
        address_constant: assert ($stable(aw_addr_o) && $stable(aw_len_o));
      end
      if ($past(rst_ni && w_valid_o && !w_ready_i)) begin
        data_stay: assert (w_valid_o);
        data_constant: assert ($stable(w_data_o) && $stable(w_strb_o) && $stable(w_last_o));
      end
      if (sending && !aw_done) within_64: assert ({5'd0, aw_addr_o[5:3]} + aw_len_o <= 8'd7);
      if (sending && !sent) f_beat: assert (beat <= last_beat);
      if (sending && !aw_done && !sent) f_rest: assert (beat >= aw_addr_o[5:3]);
      if (sending) f_last: assert ({5'd0, last_beat} == {5'd0, aw_addr_o[5:3]} + aw_len_o);
      if ($past(rst_ni && stop_i && !sending)) stops: assert (!sending);
      if (take) same_line: assert (mask == '0 || line == dst_i[29:4]);
      // This module does not wait for ever: what is full goes out in the next clock if the sender is free.
      if ($past(rst_ni && full && !sending && !stop_i && under_way < 3'd4 && !clear_i)) progress_1: assert (sending);
    end
