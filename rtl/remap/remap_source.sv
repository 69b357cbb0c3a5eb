// Reads the words of the source through a small cache of lines of 32 bytes in four ways. The tags are looked up along
// the stream of addresses, far ahead of the data; a line that is missing is asked for there. What was asked for arrives
// in order, and is put into the cache when the access that asked for it gets its data, so that no line is replaced too
// early.
module remap_source #(
  parameter int unsigned LogLines = 8,  // 2^LogLines lines, 3 to 12
  parameter int unsigned Prefetch = 8   // lines under way at most, 1 to 8
) (
  input  logic        clk_i,
  input  logic        rst_ni,     // asynchronous, active low
  input  logic        clear_i,    // only while nothing is under way; empties the cache
  input  logic        stop_i,     // no new lines
  input  logic        valid_i,
  output logic        ready_o,
  input  logic        none_i,     // no access: a word of 0
  input  logic [29:0] addr_i,     // word address
  input  logic [87:0] side_i,     // goes along
  output logic        busy_o,     // lines are under way
  output logic        ar_valid_o,
  input  logic        ar_ready_i,
  output logic [31:0] ar_addr_o,
  input  logic        r_valid_i,  // always taken
  input  logic [63:0] r_data_i,
  output logic        valid_o,
  input  logic        ready_i,
  output logic [31:0] word_o,
  output logic [87:0] side_o
);
  localparam int unsigned Lines = 1 << LogLines;
  localparam int unsigned LogSets = LogLines - 2;
  localparam int unsigned Sets = 1 << LogSets;
  localparam int unsigned TagBits = 27 - LogSets;
  localparam logic [3:0]  Most = Prefetch[3:0];

  // Front: tags. Neighbours in a row and in a column of the source are in different sets. Of a set, the way whose line
  // came first is replaced: unlike the one used last it needs no note at each access, and for the lenses it is as good.
  logic [LogSets-1:0]  set;
  logic [TagBits-1:0]  tag;
  logic [3:0]          match;
  logic [Lines-1:0]    there;
  logic [2*Sets-1:0]   oldest;      // of each set
  logic [1:0]          victim, way;
  logic [LogLines-1:0] index;
  logic                hit, miss, take, space, may_ask;
  logic [3:0]          promised;    // lines asked for and not yet in the cache
  logic                filled;      // one of them goes into the cache
  assign set = addr_i[3+:LogSets] ^ addr_i[3+LogSets+:LogSets];
  assign tag = addr_i[29-:TagBits];
  assign victim = oldest[{set, 1'b0}+:2];
  genvar w;
  generate
    for (w = 0; w < 4; w = w + 1) begin : g_way
      localparam logic [1:0] Way = w;
      logic [TagBits-1:0] tags [0:Sets-1];
      assign match[w] = there[{set, Way}] && tags[set] == tag;
      always_ff @(posedge clk_i)
        if (miss && victim == Way) tags[set] <= tag;
    end
  endgenerate
  assign way = match == 4'd0 ? victim : {match[3] || match[2], match[3] || match[1]};
  assign index = {set, way};
  assign hit = none_i || match != 4'd0;
  assign may_ask = !stop_i && promised != Most && (!ar_valid_o || ar_ready_i);
  assign ready_o = space && (hit || may_ask);
  assign take = valid_i && ready_o;
  assign miss = take && !hit;
  logic [Lines-1:0] one;
  assign one = {{(Lines-1){1'b0}}, 1'b1} << index;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      there <= '0;
      oldest <= '0;
      ar_valid_o <= 1'b0;
      ar_addr_o <= '0;
      promised <= '0;
    end else if (clear_i) begin
      there <= '0;
      oldest <= '0;
      ar_valid_o <= 1'b0;
      promised <= '0;
    end else begin
      if (miss) begin
        there <= there | one;
        oldest[{set, 1'b0}+:2] <= victim + 2'd1;
        ar_valid_o <= 1'b1;
        ar_addr_o <= {addr_i[29:3], 5'd0};
      end else if (ar_ready_i) begin
        ar_valid_o <= 1'b0;
      end
      promised <= promised + {3'd0, miss} - {3'd0, filled};
    end

  // Lines as they come: four beats.
  logic [191:0] part;
  logic [1:0]   beats;
  logic [5:0]   under_way;   // beats
  logic         line_in, line_valid, line_space;
  logic [255:0] line;
  logic [3:0]   line_count;
  assign line_in = r_valid_i && beats == 2'd3;
  always_ff @(posedge clk_i)
    if (r_valid_i) part <= {r_data_i, part[191:64]};
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      beats <= '0;
      under_way <= '0;
    end else if (clear_i) begin
      beats <= '0;
      under_way <= '0;
    end else begin
      if (r_valid_i) beats <= beats + 1'b1;
      under_way <= under_way + (miss ? 6'd4 : 6'd0) - {5'd0, r_valid_i};
    end
  assign busy_o = under_way != '0;
  remap_fifo #(.Width(256), .LogDepth(3)) u_lines (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .valid_i(line_in), .ready_o(line_space),
    .data_i({r_data_i, part}), .valid_o(line_valid), .ready_i(filled), .data_o(line), .count_o(line_count)
  );

  // Accesses that wait for their turn.
  localparam int unsigned W = 88 + 1 + 1 + LogLines + 3;
  logic [W-1:0]        wait_data;
  logic                wait_valid, wait_ready, is_none, is_miss;
  logic [LogLines-1:0] wait_index;
  logic [2:0]          wait_word;
  logic [87:0]         wait_side;
  logic [5:0]          wait_count;
  remap_fifo #(.Width(W), .LogDepth(5)) u_waiting (
    .clk_i(clk_i), .rst_ni(rst_ni), .clear_i(clear_i), .valid_i(take), .ready_o(space),
    .data_i({side_i, none_i, miss, index, addr_i[2:0]}), .valid_o(wait_valid), .ready_i(wait_ready),
    .data_o(wait_data), .count_o(wait_count)
  );
  assign {wait_side, is_none, is_miss, wait_index, wait_word} = wait_data;

  // Back: the data.
  logic [255:0] data [0:Lines-1];
  logic [255:0] from_cache, from_line, chosen;
  logic         go, new_line, none;
  logic [2:0]   word;
  assign go = ready_i || !valid_o;
  assign wait_ready = go && (!is_miss || line_valid);
  assign filled = wait_valid && wait_ready && is_miss;
  always_ff @(posedge clk_i) begin
    if (filled) data[wait_index] <= line;
    if (wait_valid && wait_ready) begin
      from_cache <= data[wait_index];
      from_line <= line;
      new_line <= is_miss;
      none <= is_none;
      word <= wait_word;
      side_o <= wait_side;
    end
  end
  assign chosen = new_line ? from_line : from_cache;
  assign word_o = none ? 32'd0 : chosen[{word, 5'd0}+:32];
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) valid_o <= 1'b0;
    else if (clear_i) valid_o <= 1'b0;
    else if (go) valid_o <= wait_valid && wait_ready;
  logic unused;
  assign unused = ^{line_space, line_count, wait_count};

`ifdef FORMAL
  `include "remap_source_props.svh"
`endif
endmodule
