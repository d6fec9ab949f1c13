// Replaces operator new in the program that links it by one that can fail.
#pragma once

namespace atlas::test {

// Lets the n-th allocation from now on fail, once. 0: none.
void let_allocation_fail(long n);

// Whether it has failed. Afterwards none fails.
bool allocation_failed();

}  // namespace atlas::test
