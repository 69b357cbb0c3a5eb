// Makes the words of the result: the source word as it is, or four of them blended bilinearly.
// Latency: 1 cycle after the last word of a beat.
module remap_blend (
  input  logic             clk_i,
  input  logic             rst_ni,     // asynchronous, active low
  input  logic             clear_i,
  input  logic             bilinear_i,
  input  logic [31:0]      border_i,
  input  logic             valid_i,
  output logic             ready_o,
  input  logic [31:0]      word_i,     // bytes Cb Y0 Cr Y1, lowest first
  input  logic [1:0]       which_i,    // of the beat's words: left, right, left below, right below
  input  logic             final_i,    // the last of them
  input  remap_pkg::beat_t beat_i,
  output logic             valid_o,
  input  logic             ready_i,
  output logic [31:0]      word_o,
  output logic [29:0]      dst_o,
  output logic             last_o
);
  logic [31:0] w00, w01, w10, w11, right_top, right_bottom;
  logic        go, ends;
  assign go = ready_i || !valid_o;
  assign ready_o = !final_i || go;
  assign ends = valid_i && final_i && go;
  always_ff @(posedge clk_i)
    if (valid_i) begin
      if (which_i == 2'd0) w00 <= word_i;
      if (which_i == 2'd1) w01 <= word_i;
      if (which_i == 2'd2) w10 <= word_i;
    end
  assign w11 = word_i;
  // Beyond the last word of a row its last pixel is repeated.
  assign right_top = beat_i.edge_x ? {w00[31:16], w00[31:24], w00[7:0]} : w01;
  assign right_bottom = beat_i.edge_x ? {w10[31:16], w10[31:24], w10[7:0]} : w11;

  logic [8:0]  fx, fy, fc, gx, gy, gc;
  logic [23:0] top, bottom;   // luma samples at the position, one and two to the right
  logic [31:0] blended;
  assign fx = {1'b0, beat_i.frac_x};
  assign fy = {1'b0, beat_i.frac_y};
  assign fc = {1'b0, beat_i.odd, beat_i.frac_x[7:1]};  // chroma has half the pixels
  assign gx = 9'd256 - fx;
  assign gy = 9'd256 - fy;
  assign gc = 9'd256 - fc;
  assign top = beat_i.odd ? {right_top[31:24], right_top[15:8], w00[31:24]}
                                : {right_top[15:8], w00[31:24], w00[15:8]};
  assign bottom = beat_i.odd ? {right_bottom[31:24], right_bottom[15:8], w10[31:24]}
                                   : {right_bottom[15:8], w10[31:24], w10[15:8]};
  remap_lerp u_cb (.a_i(w00[7:0]), .b_i(right_top[7:0]), .c_i(w10[7:0]), .d_i(right_bottom[7:0]),
                   .fx_i(fc), .gx_i(gc), .fy_i(fy), .gy_i(gy), .o_o(blended[7:0]));
  remap_lerp u_y0 (.a_i(top[7:0]), .b_i(top[15:8]), .c_i(bottom[7:0]), .d_i(bottom[15:8]),
                   .fx_i(fx), .gx_i(gx), .fy_i(fy), .gy_i(gy), .o_o(blended[15:8]));
  remap_lerp u_cr (.a_i(w00[23:16]), .b_i(right_top[23:16]), .c_i(w10[23:16]), .d_i(right_bottom[23:16]),
                   .fx_i(fc), .gx_i(gc), .fy_i(fy), .gy_i(gy), .o_o(blended[23:16]));
  remap_lerp u_y1 (.a_i(top[15:8]), .b_i(top[23:16]), .c_i(bottom[15:8]), .d_i(bottom[23:16]),
                   .fx_i(fx), .gx_i(gx), .fy_i(fy), .gy_i(gy), .o_o(blended[31:24]));

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) valid_o <= 1'b0;
    else if (clear_i) valid_o <= 1'b0;
    else if (go) valid_o <= ends;
  always_ff @(posedge clk_i)
    if (ends) begin
      word_o <= beat_i.border ? border_i : bilinear_i ? blended : word_i;
      dst_o <= beat_i.dst;
      last_o <= beat_i.last;
    end
  logic unused;
  assign unused = ^{beat_i.src, beat_i.bad, beat_i.edge_y};
endmodule
