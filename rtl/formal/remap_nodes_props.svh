  `include "remap_formal.svh"
  // The reader goes on by one row of cells at a time, after it has seen both rows of nodes; a start begins at row 0.
  always_comb begin
    assume (nodes_i >= 9'd2 && nodes_i <= 9'd256);
    assume (rows_i >= 13'd2 && rows_i <= 13'd1025);
  end
  logic f_started = 1'b0;
  always_ff @(posedge clk_i) f_started <= rst_ni && !clear_i && (start_i || f_started);
  always_ff @(posedge clk_i)
    if (f_past) begin
      assume ($stable(nodes_i) && $stable(rows_i));
      if (start_i) assume (!f_started);
      if ($past(start_i) || !f_started) assume (cell_row_i == '0);
      assume ({1'b0, cell_row_i} + 13'd1 < rows_i);
      if (f_started && !$past(start_i))
        assume (cell_row_i == $past(cell_row_i) ||
                (cell_row_i == $past(cell_row_i) + 12'd1 && $past(there_o)));
    end
  always_ff @(posedge clk_i)
    if (f_past && rst_ni && f_started) begin
      node_within: assert ({1'b0, node} < nodes_i);
      four_at_most: assert (rows_there <= cell_row + 13'd4);
      not_behind: assert (rows_there >= cell_row);
      no_more_than_asked: assert (rows_there <= rows_i);
      loading_until_all: assert (loading == (rows_there != rows_i));
      // What the reader may read is not written over.
      if (take && there_o) needed_stays: assert (rows_there[1:0] != cell_row[1:0] && rows_there[1:0] != next_row[1:0]);
      // This module does not wait for ever: while rows are missing, they are asked for.
      if (!there_o) no_deadlock: assert (map_ready_o);
    end
