// The product's command checker and data sheets by the names that these tests use.
#pragma once
#include "model/mem/check/command_checker.h"
#include "model/mem/check/data_sheet.h"
#include "model/mem/check/part_checker.h"

namespace fovea::dram {
using mem::check::Command;
using mem::check::CommandChecker;
using mem::check::Complaint;
using mem::check::DataSheet;
using mem::check::find_part;
using mem::check::in_clocks;
using mem::check::Part;
using mem::check::PartChecker;
}  // namespace fovea::dram
