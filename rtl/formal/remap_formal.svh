// Reset at the beginning, none later; f_past says that the clock before exists.
logic f_past = 1'b0;
always_ff @(posedge clk_i) f_past <= 1'b1;
always_comb begin
  if (!f_past) assume (!rst_ni);
  if (f_past) assume (rst_ni);
end
