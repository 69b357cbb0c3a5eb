// First-in, first-out buffer with valid/ready on both sides.
// Latency: 1 cycle. Throughput: one element per cycle while both sides are ready.
module remap_fifo #(
  parameter int unsigned Width = 32,
  parameter int unsigned LogDepth = 2  // 2^LogDepth elements
) (
  input  logic              clk_i,
  input  logic              rst_ni,     // asynchronous, active low
  input  logic              clear_i,    // forgets all elements
  input  logic              valid_i,
  output logic              ready_o,
  input  logic [Width-1:0]  data_i,
  output logic              valid_o,
  input  logic              ready_i,
  output logic [Width-1:0]  data_o,
  output logic [LogDepth:0] count_o     // elements held
);
  localparam logic [LogDepth:0] Full = {1'b1, {LogDepth{1'b0}}};
  localparam logic [LogDepth:0] One = {{LogDepth{1'b0}}, 1'b1};

  logic [Width-1:0]    store [0:(1<<LogDepth)-1];
  logic [LogDepth-1:0] head, tail;      // next to read, next to write
  logic                push, pop;

  assign ready_o = count_o != Full;
  assign valid_o = count_o != '0;
  assign push = valid_i && ready_o;
  assign pop = valid_o && ready_i;
  assign data_o = store[head];

  always_ff @(posedge clk_i)
    if (push) store[tail] <= data_i;

  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) begin
      head <= '0;
      tail <= '0;
      count_o <= '0;
    end else if (clear_i) begin
      head <= '0;
      tail <= '0;
      count_o <= '0;
    end else begin
      if (push) tail <= tail + 1'b1;
      if (pop) head <= head + 1'b1;
      if (push && !pop) count_o <= count_o + One;
      if (pop && !push) count_o <= count_o - One;
    end

`ifdef FORMAL
`ifndef FORMAL_FIFO_PROVEN  // defined where the buffer is a part, and its own proof is relied on
  `include "remap_fifo_props.svh"
`endif
`endif
endmodule
