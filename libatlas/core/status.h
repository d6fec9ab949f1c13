// How the library reports errors. Bad data and failed input or output return a Status whose message
// names the file, the place, the reason and a remedy. Broken preconditions assert; they are
// undefined behaviour if NDEBUG is defined.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>

namespace atlas {

enum class ErrorCode {
  ok,
  cancelled,    // the caller's cancel flag was raised
  not_found,    // a file that was asked for is not there
  io,           // reading or writing failed
  bad_input,    // the data does not follow its format, or holds nothing usable
  bad_option,   // an option is out of range
  unsupported,  // valid, but beyond what this build handles
  no_solution,  // the constraints cannot be met
};

// Success, or an error code with one line of text for the user.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(ErrorCode code, std::string message) : code_(code), message_(std::move(message)) {}

  static Status cancelled() { return {ErrorCode::cancelled, "cancelled"}; }

  bool ok() const { return code_ == ErrorCode::ok; }
  ErrorCode code() const { return code_; }
  const std::string& message() const { return message_; }

 private:
  ErrorCode code_ = ErrorCode::ok;
  std::string message_;
};

// A value, or the Status that says why there is none. Check ok() before value(), * or ->.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}
  Result(Status status) : status_(std::move(status)) { assert(!status_.ok()); }

  bool ok() const { return value_.has_value(); }
  const Status& status() const { return status_; }
  T& value() {
    assert(ok());
    return *value_;
  }
  const T& value() const {
    assert(ok());
    return *value_;
  }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  std::optional<T> value_;
  Status status_;
};

}  // namespace atlas
