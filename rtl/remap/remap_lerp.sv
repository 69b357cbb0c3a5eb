// Bilinear interpolation between four samples, rounded: weights of 256 in sum on each axis. Combinational.
module remap_lerp (
  input  logic [7:0] a_i,   // left, right, left below, right below
  input  logic [7:0] b_i,
  input  logic [7:0] c_i,
  input  logic [7:0] d_i,
  input  logic [8:0] fx_i,  // weight of the right, of the left, of the lower, of the upper ones
  input  logic [8:0] gx_i,
  input  logic [8:0] fy_i,
  input  logic [8:0] gy_i,
  output logic [7:0] o_o
);
  logic [16:0] top, bottom;
  logic [25:0] sum;
  assign top = {8'd0, gx_i} * {9'd0, a_i} + {8'd0, fx_i} * {9'd0, b_i};
  assign bottom = {8'd0, gx_i} * {9'd0, c_i} + {8'd0, fx_i} * {9'd0, d_i};
  assign sum = {17'd0, gy_i} * {9'd0, top} + {17'd0, fy_i} * {9'd0, bottom} + 26'd32768;
  assign o_o = sum[23:16];
  logic unused;
  assign unused = ^{sum[25:24], sum[15:0]};
endmodule
