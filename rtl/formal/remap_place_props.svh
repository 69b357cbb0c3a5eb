  `include "remap_formal.svh"
  `include "remap_job_props.svh"
  always_ff @(posedge clk_i)
    if (f_past && rst_ni && busy_o) begin
      pair_within: assert ({1'b0, pair} < job_i.pairs);
      row_within: assert ({1'b0, row} < job_i.rows);
      dst_within_row: assert (dst_o == row_dst + {19'd0, pair});
      if ($past(rst_ni && busy_o && !step_i && !clear_i)) waits: assert ($stable(dst_o) && $stable(last_o));
      last_once: assert (!$past(rst_ni && busy_o && last_o && step_i));
    end
