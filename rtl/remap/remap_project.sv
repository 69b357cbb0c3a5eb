// Source position by division of two linear forms by a third: plane to plane, as for a bird's-eye view.
// Latency: 22 cycles. Throughput: one position per cycle while ready_i is high.
module remap_project (
  input  logic                                  clk_i,
  input  logic                                  rst_ni,   // asynchronous, active low
  input  logic                                  clear_i,
  input  logic                                  valid_i,
  output logic                                  ready_o,
  input  logic signed [remap_pkg::FormBits-1:0] a_i,      // numerator of x
  input  logic signed [remap_pkg::FormBits-1:0] b_i,      // numerator of y
  input  logic signed [remap_pkg::FormBits-1:0] c_i,      // denominator
  output logic                                  valid_o,
  input  logic                                  ready_i,
  output logic signed [remap_pkg::PosBits-1:0]  x_o,
  output logic signed [remap_pkg::PosBits-1:0]  y_o,
  output logic                                  out_o     // behind the camera, or beyond all sources
);
  localparam int unsigned F = remap_pkg::FormBits;
  localparam int unsigned Steps = 21;  // bits of a quotient: 13 of the integer, 8 behind the point
  localparam int unsigned DenBits = 24;
  localparam int unsigned RemBits = DenBits + 14;  // twice the shifted denominator, less one

  logic go;
  assign go = ready_i || !valid_o;
  assign ready_o = go;

  // Stage 0 takes signs and sizes; stage k + 1 has found bit Steps - 1 - k of both quotients.
  logic [Steps:0]             v, out, neg_x, neg_y;
  logic [(Steps+1)*DenBits-1:0] den;
  logic [(Steps+1)*RemBits-1:0] rem_x, rem_y;
  logic [(Steps+1)*Steps-1:0] quo_x, quo_y;

  logic [F-1:0] size_a, size_b;
  logic bad_c, big_a, big_b;
  assign size_a = a_i[F-1] ? ~a_i + 1'b1 : a_i;
  assign size_b = b_i[F-1] ? ~b_i + 1'b1 : b_i;
  assign bad_c = c_i <= 36'sd0 || c_i[F-1:DenBits] != '0;
  assign big_a = {1'b0, size_a} >= {c_i[DenBits-1:0], 13'd0};
  assign big_b = {1'b0, size_b} >= {c_i[DenBits-1:0], 13'd0};

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) v <= '0;
    else if (clear_i) v <= '0;
    else if (go) v <= {v[Steps-1:0], valid_i};

  always_ff @(posedge clk_i)
    if (go) begin
      out[0] <= bad_c || big_a || big_b;
      neg_x[0] <= a_i[F-1];
      neg_y[0] <= b_i[F-1];
      den[DenBits-1:0] <= c_i[DenBits-1:0];
      rem_x[RemBits-1:0] <= {{(RemBits-F){1'b0}}, size_a};
      rem_y[RemBits-1:0] <= {{(RemBits-F){1'b0}}, size_b};
      quo_x[Steps-1:0] <= '0;
      quo_y[Steps-1:0] <= '0;
    end

  genvar k;
  generate
    for (k = 0; k < Steps; k = k + 1) begin : gen_step
      logic [RemBits-1:0] d, rx, ry, sub_x, sub_y;
      logic ge_x, ge_y;
      assign d = {2'b00, den[k*DenBits+:DenBits], 12'd0};
      assign rx = rem_x[k*RemBits+:RemBits];
      assign ry = rem_y[k*RemBits+:RemBits];
      assign ge_x = rx >= d;
      assign ge_y = ry >= d;
      assign sub_x = ge_x ? rx - d : rx;
      assign sub_y = ge_y ? ry - d : ry;
      always_ff @(posedge clk_i)
        if (go) begin
          out[k+1] <= out[k];
          neg_x[k+1] <= neg_x[k];
          neg_y[k+1] <= neg_y[k];
          den[(k+1)*DenBits+:DenBits] <= den[k*DenBits+:DenBits];
          rem_x[(k+1)*RemBits+:RemBits] <= {sub_x[RemBits-2:0], 1'b0};
          rem_y[(k+1)*RemBits+:RemBits] <= {sub_y[RemBits-2:0], 1'b0};
          quo_x[(k+1)*Steps+:Steps] <= {quo_x[k*Steps+:Steps-1], ge_x};
          quo_y[(k+1)*Steps+:Steps] <= {quo_y[k*Steps+:Steps-1], ge_y};
        end
      logic unused;
      assign unused = ^{sub_x[RemBits-1], sub_y[RemBits-1], quo_x[k*Steps+Steps-1], quo_y[k*Steps+Steps-1]};
    end
  endgenerate

  logic [remap_pkg::PosBits-1:0] x, y;
  assign x = {1'b0, quo_x[Steps*Steps+:Steps], 8'd0};
  assign y = {1'b0, quo_y[Steps*Steps+:Steps], 8'd0};
  assign x_o = neg_x[Steps] ? ~x + 1'b1 : x;
  assign y_o = neg_y[Steps] ? ~y + 1'b1 : y;
  assign out_o = out[Steps];
  assign valid_o = v[Steps];

  logic unused_rem;
  assign unused_rem = ^{rem_x[Steps*RemBits+:RemBits], rem_y[Steps*RemBits+:RemBits], den[Steps*DenBits+:DenBits]};

`ifdef FORMAL
  `include "remap_stream_props.svh"
`endif
endmodule
