// Acts as another user, because root is not bound by permissions.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

namespace atlas::test {

// While an instance exists, a process of root has the rights of nobody.
class NoRoot {
 public:
  NoRoot() : user_(::getuid()) {
    if (user_ == 0) change(65534);
  }
  ~NoRoot() {
    if (user_ == 0) change(0);
  }
  NoRoot(const NoRoot&) = delete;
  NoRoot& operator=(const NoRoot&) = delete;

 private:
  // access(2) checks the real user, and all other calls check the effective one.
  static void change(uid_t user) { EXPECT_EQ(::setresuid(user, user, 0), 0); }
  uid_t user_;
};

}  // namespace atlas::test
