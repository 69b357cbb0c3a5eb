  `include "remap_formal.svh"
  `include "remap_job_props.svh"
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      if (valid_o) begin
        pair_within: assert ({1'b0, pair} < job_i.pairs);
        row_within: assert ({1'b0, row} < job_i.rows);
      end
      if ($past(rst_ni && valid_o && !ready_i && !clear_i)) begin
        offer_stays: assert (valid_o);
        offer_constant: assert ($stable(a_o) && $stable(b_o) && $stable(c_o));
      end
      // Progress: after a start, or a pair that is not the last, the next is there in the next clock.
      if ($past(rst_ni && !clear_i && start_i && !valid_o)) progress_1: assert (valid_o);
      if ($past(rst_ni && !clear_i && valid_o && !job_end)) progress_2: assert (valid_o);
      if ($past(rst_ni && valid_o && ready_i && job_end)) ends: assert (!valid_o);
      if ($past(rst_ni && valid_o && ready_i && !row_end && !clear_i)) along: assert (a_o == $past(a_o) + a1);
      if ($past(rst_ni && valid_o && ready_i && row_end && !clear_i) && valid_o)
        down: assert (a_o == $past(a_row) + a2);
    end
