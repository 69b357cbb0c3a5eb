  `include "remap_formal.svh"
  // The memory answers what it was asked, and not more; nothing is cleared while something is under way.
  always_comb begin
    if (under_way == '0 || (under_way == 6'd4 && ar_valid_o)) assume (!r_valid_i);
    if (busy_o) assume (!clear_i);
  end
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      eight_at_most: assert (promised <= Most);
      // Every line that was promised is on its way or in the buffer; so lines always find room.
      f_beats: assert ({2'd0, under_way} + {6'd0, beats} == {2'd0, promised - line_count, 2'b00} && line_count <= promised);
      f_asked: assert (!ar_valid_o || under_way >= 6'd4);
      if (line_in) room: assert (line_space);
      if ($past(rst_ni && ar_valid_o && !ar_ready_i && !clear_i)) begin
        offer_stays: assert (ar_valid_o);
        offer_constant: assert ($stable(ar_addr_o));
      end
      if ($past(rst_ni && valid_o && !ready_i && !clear_i)) begin
        word_stays: assert (valid_o);
        word_constant: assert ($stable(word_o) && $stable(side_o));
      end
      if ($past(rst_ni && stop_i && !ar_valid_o)) stops: assert (!ar_valid_o);
      aligned: assert (ar_addr_o[4:0] == '0);
    end
