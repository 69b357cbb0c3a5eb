  `include "remap_formal.svh"
  // The bus' master keeps the rules of AXI4-Lite; the engine ends no job that it has not taken.
  always_ff @(posedge clk_i)
    if (f_past && rst_ni && $past(rst_ni)) begin
      if ($past(s_aw_valid_i && !s_aw_ready_o)) assume (s_aw_valid_i && $stable(s_aw_addr_i));
      if ($past(s_w_valid_i && !s_w_ready_o)) assume (s_w_valid_i && $stable(s_w_data_i) && $stable(s_w_strb_i));
      if ($past(s_ar_valid_i && !s_ar_ready_o)) assume (s_ar_valid_i && $stable(s_ar_addr_i));
    end
  always_comb assume (!done_i || (running && !ended));
  // What was taken and not answered: addresses, data and reads.
  logic [1:0] f_addresses, f_data, f_reads;
  always_ff @(posedge clk_i or negedge rst_ni)
    if (!rst_ni) {f_addresses, f_data, f_reads} <= 6'd0;
    else begin
      f_addresses <= f_addresses + {1'b0, s_aw_valid_i && s_aw_ready_o} - {1'b0, s_b_valid_o && s_b_ready_i};
      f_data <= f_data + {1'b0, s_w_valid_i && s_w_ready_o} - {1'b0, s_b_valid_o && s_b_ready_i};
      f_reads <= f_reads + {1'b0, s_ar_valid_i && s_ar_ready_o} - {1'b0, s_r_valid_o && s_r_ready_i};
    end
  // A job is offered until it is taken, unless CTRL is written. That it is constant is the buffer's proof.
  logic f_control;
  assign f_control = write && write_word == remap_regs_pkg::CTRL_WORD;
  always_ff @(posedge clk_i)
    if (f_past && rst_ni) begin
      write_answered: assert ({1'b0, s_b_valid_o} == f_addresses);
      data_answered: assert ({1'b0, s_b_valid_o} == f_data);
      read_answered: assert ({1'b0, s_r_valid_o} == f_reads);
      if ($past(rst_ni && s_b_valid_o && !s_b_ready_i)) write_answer_stays: assert (s_b_valid_o && $stable(s_b_resp_o));
      if ($past(rst_ni && s_r_valid_o && !s_r_ready_i))
        read_answer_stays: assert (s_r_valid_o && $stable(s_r_data_o) && $stable(s_r_resp_o));
      // Progress: who has no answer to wait for is taken at once.
      if (s_aw_valid_i && s_w_valid_i && !s_b_valid_o) write_taken: assert (s_aw_ready_o && s_w_ready_o);
      if (s_ar_valid_i && !s_r_valid_o) read_taken: assert (s_ar_ready_o);
      bounded: assert ({{(31-LogQueue){1'b0}}, count} <= QueueDepth);
      interrupt: assert (irq_o == ((events & enables) != 7'd0));
      drops: assert (!abort_o || !take);
      if ($past(rst_ni && job_valid_o && !job_ready_i && !f_control) && !abort_o)
        offer_stays: assert (job_valid_o);
      if ($past(rst_ni && abort_o)) emptied: assert (count == '0);
      if ($past(rst_ni && abort_o && waiting)) drop_reported: assert (events[remap_regs_pkg::EVENTS_DROPPED_LSB]);
      if ($past(rst_ni && submit && !room))
        overflow_reported: assert (events[remap_regs_pkg::EVENTS_OVERFLOW_LSB] && count <= $past(count));
      if ($past(rst_ni && submit && room && !take)) pushed: assert (count == $past(count) + 1'b1);
      if ($past(rst_ni && take)) under_way: assert (running && tag == $past(next_tag));
      if ($past(rst_ni && ended)) end_reported: assert ((events & $past(result)) == $past(result) && last_result != '0);
      if ($past(rst_ni && running && !ended)) stays_under_way: assert (running);
      if ($past(rst_ni) && $past(events & ~cleared) != 7'd0)
        events_stay: assert ((events & $past(events & ~cleared)) == $past(events & ~cleared));
      if ($past(rst_ni && !write)) silent: assert ($stable(mode) && $stable(c2) && $stable(enables) && $stable(enable));
    end
