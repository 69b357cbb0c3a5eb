  `include "remap_formal.svh"
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      if ($past(rst_ni && valid_o && !ready_i && !clear_i)) begin
        offer_stays: assert (valid_o);
        offer_constant: assert ($stable(x_o) && $stable(y_o));
      end
      if ($past(rst_ni && clear_i)) cleared: assert (!valid_o);
    end
