  `include "remap_formal.svh"
  // One slot, any of them, remembers what was put into it.
  (* anyconst *) logic [LogDepth-1:0] f_slot;
  logic [Width-1:0] f_shadow;
  logic             f_held;
  logic [LogDepth-1:0] f_offset;
  assign f_offset = f_slot - head;
  assign f_held = {1'b0, f_offset} < count_o;
  always_ff @(posedge clk_i)
    if (push && tail == f_slot) f_shadow <= data_i;
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      bounded: assert (count_o <= Full);
      consistent: assert (tail == head + count_o[LogDepth-1:0]);
      kept: assert (!f_held || store[f_slot] == f_shadow);
      in_order: assert (!(valid_o && head == f_slot) || data_o == f_shadow);
      if ($past(rst_ni && valid_o && !ready_i && !clear_i)) begin
        offer_stays: assert (valid_o);
        offer_constant: assert ($stable(data_o));
      end
      if ($past(rst_ni && ready_o && !valid_i && !clear_i)) space_stays: assert (ready_o);
      if ($past(rst_ni && clear_i)) cleared: assert (!valid_o);
      // Progress: what is put in can be taken out in the next clock.
      if ($past(rst_ni && push && !clear_i)) progress_1: assert (valid_o);
      full_once: cover (count_o == Full);
      full_then_empty: cover ($past(count_o == Full) && $past(pop) && !ready_o == 1'b0);
    end
