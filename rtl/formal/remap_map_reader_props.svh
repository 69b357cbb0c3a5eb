  `include "remap_formal.svh"
  // The memory answers what it was asked, and not more; nothing is cleared while something is under way.
  logic f_run = 1'b0;
  always_ff @(posedge clk_i) f_run <= rst_ni;
  always_comb begin
    if (under_way == '0) assume (!r_valid_i);
    if (busy_o) assume (!clear_i);
    if (ar_valid_o || left != '0) assume (!start_i);
  end
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      never_too_much: assert ({2'd0, promised} + (ar_valid_o ? ar_len_o + 8'd1 : 8'd0) <= 8'd32);
      // What is promised is on its way or in the buffer: read data always find room.
      f_sum: assert ({2'd0, promised} == {2'd0, under_way} + {2'd0, held});
      f_high: assert (!high || held != '0);
      f_length: assert (!ar_valid_o || ar_len_o <= 8'd7);
      if (r_valid_i) room: assert (space);
      if ($past(rst_ni && ar_valid_o && !ar_ready_i && !clear_i)) begin
        offer_stays: assert (ar_valid_o);
        offer_constant: assert ($stable(ar_addr_o) && $stable(ar_len_o));
      end
      within_4k: assert (!ar_valid_o || ar_addr_o[5:0] == '0);
      // This module does not wait for ever: with an empty buffer and beats left there is an offer in the next clock.
      if ($past(rst_ni && left != '0 && promised == '0 && !ar_valid_o && !stop_i && !clear_i && !start_i))
        progress_1: assert (ar_valid_o);
      if ($past(rst_ni && stop_i && !ar_valid_o)) stops: assert (!ar_valid_o);
    end
