// The tables of the performance page, each made from the rows that belong to it.
#pragma once

#include "benchmarks/page/document.h"
#include "benchmarks/support/results.h"

namespace atlas::bench {

// Formats a number with at least four digits if it has them: "12.3", "0.00123", "1234567".
std::string figure(double value);

void goals_table(const Results& all, Document& page);  // the project's goals
void fits_table(const Results& all, Document& page);   // fitted exponents
// As multiples of "parse and compute normals".
void limit_table(const Results& all, Document& page);
// Parts of charts, with reasons for more than twelve times.
void parts_table(const Results& all, Document& page);
void export_table(const Results& all, Document& page);   // CPU seconds of the export's stages
void threads_table(const Results& all, Document& page);  // rows measured on 1, 2, ... threads
void instructions_table(const Results& all, Document& page);
void rivals_table(const Results& all, Document& page);
// All other rows of one stage, with every value.
void stage_table(const Results& all, const std::string& stage, Document& page);
// Returns the stages of those rows in the order in which they were measured.
std::vector<std::string> stages_of(const Results& all);

}  // namespace atlas::bench
