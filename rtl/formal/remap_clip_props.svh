  `include "remap_formal.svh"
  // Products of two unknowns are hard for a solver: the bounds of the address are proven for small frames, those of
  // row and column for all.
  always_comb begin
    assume (job_i.src_width >= 13'd2 && job_i.src_width <= 13'd4096 && !job_i.src_width[0]);
    assume (job_i.src_height >= 13'd1 && job_i.src_height <= 13'd4096);
    assume (job_i.src_pitch >= {1'b0, job_i.src_width[12:1]});
`ifdef FORMAL_SMALL
    assume (job_i.src_pitch <= 13'd7 && job_i.src_height <= 13'd7);
`endif
  end
  logic f_settled = 1'b0;  // limit belongs to job_i
  logic [2:0] f_high = '0;  // clocks in which a word was on its way and the taker was ready
  always_ff @(posedge clk_i) f_settled <= f_past;
  always_ff @(posedge clk_i) begin
    if (f_past) assume ($stable(job_i));
    if (!f_settled) assume (!valid_i);
  end
  always_ff @(posedge clk_i) f_high <= rst_ni && !clear_i && ready_i && (v1 || v2) && !valid_o ? f_high + 3'd1 : 3'd0;
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      if ($past(rst_ni && valid_o && !ready_i && !clear_i)) begin
        offer_stays: assert (valid_o);
        offer_constant: assert ($stable(beat_o));
      end
      if (v1 && !table1 && !border1) begin
        column_within: assert (column1 < job_i.src_width);
        row_within: assert (line1 < job_i.src_height);
      end
      // Progress: two clocks after the first register at most.
      progress_2: assert (f_high <= 3'd2);
      if (!v1) f_two: assert (f_high <= 3'd2);
      if (v2 && bad2) f_bad: assert (border2);
      if (valid_o && beat_o.border) silent: assert (beat_o.src == '0 && beat_o.frac_x == '0 && !beat_o.odd);
      if (valid_o && beat_o.bad) bad_is_border: assert (beat_o.border);
`ifdef FORMAL_SMALL
      if (f_settled) f_limit: assert (limit == job_i.src_height * job_i.src_pitch);
      if (f_settled && v2 && !border2)
        f_second: assert (table2 ? word2 < {4'd0, limit} : {4'd0, start2} + {18'd0, half2} < {4'd0, limit});
      if (f_settled && valid_o && !beat_o.border)
        address_within: assert (beat_o.src - job_i.src_base < {4'd0, limit});
`endif
    end
