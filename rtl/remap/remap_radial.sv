// Source position by a radial gain: a piecewise quadratic polynomial of the square radius, read once per job.
// Latency: 6 cycles. Throughput: one position per cycle while ready_i is high.
module remap_radial (
  input  logic                                  clk_i,
  input  logic                                  rst_ni,   // asynchronous, active low
  input  logic                                  clear_i,
  input  logic                                  start_i,  // the pieces of job_i follow on map_i
  input  remap_pkg::job_t                       job_i,    // constant until the last position is taken
  input  logic                                  map_valid_i,
  output logic                                  map_ready_o,
  input  logic [31:0]                           map_i,    // c0, c1, c2 of each piece
  output logic                                  loaded_o, // all pieces are there
  input  logic                                  valid_i,
  output logic                                  ready_o,
  input  logic signed [remap_pkg::FormBits-1:0] a_i,      // x
  input  logic signed [remap_pkg::FormBits-1:0] b_i,      // y, of the radius
  input  logic signed [remap_pkg::FormBits-1:0] c_i,      // y, of the position
  output logic                                  valid_o,
  input  logic                                  ready_i,
  output logic signed [remap_pkg::PosBits-1:0]  x_o,
  output logic signed [remap_pkg::PosBits-1:0]  y_o,
  output logic                                  out_o     // not visible, or beyond all sources
);
  localparam int unsigned XBits = 20;     // Q8
  localparam int unsigned CoefBits = 26;  // Q20
  localparam int unsigned GainBits = 28;  // Q20
  localparam int unsigned PB = remap_pkg::PosBits;

  // The pieces: three memories, so that the three coefficients are read at once.
  logic [CoefBits-1:0] mem0 [0:remap_pkg::MaxPieces-1];
  logic [CoefBits-1:0] mem1 [0:remap_pkg::MaxPieces-1];
  logic [CoefBits-1:0] mem2 [0:remap_pkg::MaxPieces-1];
  logic [remap_pkg::PieceBits:0] piece;  // next to load
  logic [1:0] coef;
  logic loading;
  logic unused;

  assign map_ready_o = loading;
  assign unused = ^map_i[31:CoefBits];  // a coefficient has 26 bits
  always_ff @(posedge clk_i)
    if (loading && map_valid_i) begin
      if (coef == 2'd0) mem0[piece[remap_pkg::PieceBits-1:0]] <= map_i[CoefBits-1:0];
      if (coef == 2'd1) mem1[piece[remap_pkg::PieceBits-1:0]] <= map_i[CoefBits-1:0];
      if (coef == 2'd2) mem2[piece[remap_pkg::PieceBits-1:0]] <= map_i[CoefBits-1:0];
    end
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      loading <= 1'b0;
      loaded_o <= 1'b0;
      piece <= '0;
      coef <= '0;
    end else if (clear_i) begin
      loading <= 1'b0;
      loaded_o <= 1'b0;
    end else if (start_i) begin
      loading <= 1'b1;
      loaded_o <= 1'b0;
      piece <= '0;
      coef <= '0;
    end else if (loading && map_valid_i) begin
      coef <= coef == 2'd2 ? 2'd0 : coef + 2'd1;
      if (coef == 2'd2) begin
        piece <= piece + 1'b1;
        if (piece + 1'b1 == job_i.pieces) begin
          loading <= 1'b0;
          loaded_o <= 1'b1;
        end
      end
    end

  // The pipeline moves as a whole.
  logic go, v1, v2, v3, v4, v5;
  assign go = ready_i || !valid_o;
  assign ready_o = go && loaded_o;

  // 1: round to Q8, and see whether that fits.
  logic signed [XBits-1:0] x1, y1, z1;
  logic out1, a_wide, b_wide, c_wide;
  assign a_wide = a_i[remap_pkg::FormBits-1:27] != '0 && a_i[remap_pkg::FormBits-1:27] != '1;
  assign b_wide = b_i[remap_pkg::FormBits-1:27] != '0 && b_i[remap_pkg::FormBits-1:27] != '1;
  assign c_wide = c_i[remap_pkg::FormBits-1:27] != '0 && c_i[remap_pkg::FormBits-1:27] != '1;
  // 2: squares, Q16.
  logic signed [XBits-1:0] x2, z2;
  logic signed [2*XBits-1:0] xx2, yy2;
  logic out2;
  // 3: piece and place in it, Q16.
  logic [2*XBits-1:0] s, moved;
  logic [CoefBits-1:0] k0_3, k1_3, k2_3;
  logic [15:0] t3;
  logic signed [XBits-1:0] x3, z3;
  logic out3;
  assign s = xx2 + yy2;
  assign moved = s >> job_i.piece_log2;
  // 4: inner sum of the gain.
  logic signed [CoefBits+16:0] square;       // c2 t
  logic signed [CoefBits:0] inner, inner4;
  logic [CoefBits-1:0] k0_4;
  logic [15:0] t4;
  logic signed [XBits-1:0] x4, z4;
  logic out4;
  assign square = $signed(k2_3) * $signed({1'b0, t3});
  assign inner = $signed({k1_3[CoefBits-1], k1_3}) + $signed(square[CoefBits+16:16]);
  // 5: gain.
  logic signed [CoefBits+17:0] line;         // inner t
  logic signed [GainBits-1:0] gain, gain5;
  logic signed [XBits-1:0] x5, z5;
  logic out5;
  assign line = inner4 * $signed({1'b0, t4});
  assign gain = $signed({{2{k0_4[CoefBits-1]}}, k0_4}) + $signed(line[CoefBits+17:16]);
  // 6: position.
  logic signed [GainBits+XBits-1:0] gx, gz;  // Q28
  logic signed [GainBits+XBits-12:0] px, pz; // Q16
  logic px_wide, pz_wide;
  assign gx = gain5 * x5;
  assign gz = gain5 * z5;
  assign px = $signed({gx[GainBits+XBits-1], gx[GainBits+XBits-1:12]}) +
              $signed({{5{job_i.centre_x[31]}}, job_i.centre_x});
  assign pz = $signed({gz[GainBits+XBits-1], gz[GainBits+XBits-1:12]}) +
              $signed({{5{job_i.centre_y[31]}}, job_i.centre_y});
  assign px_wide = px[GainBits+XBits-12:PB-1] != '0 && px[GainBits+XBits-12:PB-1] != '1;
  assign pz_wide = pz[GainBits+XBits-12:PB-1] != '0 && pz[GainBits+XBits-12:PB-1] != '1;

  always_ff @(posedge clk_i)
    if (go) begin
      x1 <= a_i[27:8];
      y1 <= b_i[27:8];
      z1 <= c_i[27:8];
      out1 <= a_wide || b_wide || c_wide;

      xx2 <= x1 * x1;
      yy2 <= y1 * y1;
      x2 <= x1;
      z2 <= z1;
      out2 <= out1;

      k0_3 <= mem0[moved[16+:remap_pkg::PieceBits]];
      k1_3 <= mem1[moved[16+:remap_pkg::PieceBits]];
      k2_3 <= mem2[moved[16+:remap_pkg::PieceBits]];
      t3 <= moved[15:0];
      x3 <= x2;
      z3 <= z2;
      out3 <= out2 || moved[39:16] >= {16'd0, job_i.pieces} || s[39:8] > job_i.radius_limit;

      inner4 <= inner;
      k0_4 <= k0_3;
      t4 <= t3;
      x4 <= x3;
      z4 <= z3;
      out4 <= out3;

      gain5 <= gain;
      x5 <= x4;
      z5 <= z4;
      out5 <= out4;

      x_o <= px[PB-1:0];
      y_o <= pz[PB-1:0];
      out_o <= out5 || px_wide || pz_wide;
    end

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      {v1, v2, v3, v4, v5, valid_o} <= 6'd0;
    end else if (clear_i) begin
      {v1, v2, v3, v4, v5, valid_o} <= 6'd0;
    end else if (go) begin
      {v1, v2, v3, v4, v5, valid_o} <= {valid_i && loaded_o, v1, v2, v3, v4, v5};
    end

  logic unused_bits;
  assign unused_bits = ^{a_i[7:0], b_i[7:0], c_i[7:0], square[15:0], line[15:0], gx[11:0], gz[11:0]};

`ifdef FORMAL
  `include "remap_stream_props.svh"
`endif
endmodule
