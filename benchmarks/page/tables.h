// The tables of the performance page, each from the rows that belong to it.
#pragma once

#include "benchmarks/page/document.h"
#include "benchmarks/support/results.h"

namespace atlas::bench {

// "12.3", "0.00123", "1234567": four digits at least where there are four.
std::string figure(double value);

void goals_table(const Results& all, Document& page);    // what the project asks of itself
void fits_table(const Results& all, Document& page);     // exponents
void limit_table(const Results& all, Document& page);    // times "parse and compute normals"
void parts_table(const Results& all, Document& page);    // of charts, and why beyond twelve times
void export_table(const Results& all, Document& page);   // CPU seconds of the export's stages
void threads_table(const Results& all, Document& page);  // rows measured on 1, 2, ... threads
void instructions_table(const Results& all, Document& page);
void rivals_table(const Results& all, Document& page);
// All other rows of one stage, with every value.
void stage_table(const Results& all, const std::string& stage, Document& page);
// Stages of those rows in the order in which they were measured.
std::vector<std::string> stages_of(const Results& all);

}  // namespace atlas::bench
