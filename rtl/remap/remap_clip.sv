// Turns source positions, or the entries of a table, into word addresses, and finds what has no source.
// Latency: 3 cycles. Throughput: one per cycle while ready_i is high.
module remap_clip (
  input  logic                                 clk_i,
  input  logic                                 rst_ni,   // asynchronous, active low
  input  logic                                 clear_i,
  input  remap_pkg::job_t                      job_i,    // constant while anything is under way
  input  logic                                 valid_i,
  output logic                                 ready_o,
  input  logic                                 table_i,  // entry_i counts, not the position
  input  logic [31:0]                          entry_i,  // bytes from the frame's first
  input  logic signed [remap_pkg::PosBits-1:0] x_i,      // pixels, Q16
  input  logic signed [remap_pkg::PosBits-1:0] y_i,
  input  logic                                 out_i,    // the position is no position
  output logic                                 valid_o,
  input  logic                                 ready_i,
  output remap_pkg::beat_t                     beat_o    // dst and last are 0
);
  localparam int unsigned PB = remap_pkg::PosBits;
  logic go, v1, v2;
  assign go = ready_i || !valid_o;
  assign ready_o = go;

  // The first word behind the frame. Jobs begin cycles before their first position.
  logic [25:0] limit;
  always_ff @(posedge clk_i) limit <= job_i.src_height * job_i.src_pitch;

  // 1: nearest pixel, or the one whose right and lower neighbours are interpolated with it.
  logic signed [PB:0] x, y;
  logic signed [PB-16:0] column, line;
  logic has_source;
  assign x = $signed({x_i[PB-1], x_i}) + (job_i.bilinear ? 31'sd0 : 31'sh8000);
  assign y = $signed({y_i[PB-1], y_i}) + (job_i.bilinear ? 31'sd0 : 31'sh8000);
  assign column = x[PB:16];
  assign line = y[PB:16];
  assign has_source = !out_i && column[PB-16:13] == 2'b00 && column[12:0] < job_i.src_width &&
                      line[PB-16:13] == 2'b00 && line[12:0] < job_i.src_height;
  logic [12:0] column1, line1;
  logic [29:0] word1, word2;
  logic [7:0]  frac_x1, frac_y1, frac_x2, frac_y2;
  logic        border1, bad1, border2, bad2, odd2, edge_x2, edge_y2;
  // 2: row times pitch.
  logic [25:0] start2;
  logic [11:0] half2;
  logic        table1, table2;
  logic        beyond;
  assign beyond = word1 >= {4'd0, limit};

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) {v1, v2, valid_o} <= 3'd0;
    else if (clear_i) {v1, v2, valid_o} <= 3'd0;
    else if (go) {v1, v2, valid_o} <= {valid_i, v1, v2};

  always_ff @(posedge clk_i)
    if (go) begin
      table1 <= table_i;
      column1 <= column[12:0];
      line1 <= line[12:0];
      frac_x1 <= x[15:8];
      frac_y1 <= y[15:8];
      word1 <= entry_i[31:2];
      border1 <= !table_i && !has_source;
      bad1 <= table_i && entry_i[1:0] != 2'b00;

      table2 <= table1;
      start2 <= line1 * job_i.src_pitch;
      half2 <= column1[12:1];
      odd2 <= !table1 && job_i.bilinear && column1[0];
      edge_x2 <= !table1 && column1[12:1] + 12'd1 == job_i.src_width[12:1];
      edge_y2 <= !table1 && line1 + 13'd1 == job_i.src_height;
      frac_x2 <= !table1 && job_i.bilinear ? frac_x1 : 8'd0;
      frac_y2 <= !table1 && job_i.bilinear ? frac_y1 : 8'd0;
      word2 <= word1;
      border2 <= border1 || bad1 || (table1 && beyond);
      bad2 <= bad1 || (table1 && beyond && word1 != {4'd0, limit});

      beat_o.last <= 1'b0;
      beat_o.dst <= 30'd0;
      beat_o.border <= border2;
      beat_o.bad <= bad2;
      beat_o.edge_x <= edge_x2 && !border2;
      beat_o.edge_y <= edge_y2 && !border2;
      beat_o.odd <= odd2 && !border2;
      beat_o.frac_x <= border2 ? 8'd0 : frac_x2;
      beat_o.frac_y <= border2 ? 8'd0 : frac_y2;
      beat_o.src <= border2 ? 30'd0
                            : job_i.src_base + (table2 ? word2 : {4'd0, start2} + {18'd0, half2});
    end

  logic unused;
  assign unused = ^{x[7:0], y[7:0], job_i.src_width[0]};

`ifdef FORMAL
  `include "remap_clip_props.svh"
`endif
endmodule
