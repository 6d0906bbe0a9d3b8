#pragma once
/// Typed exceptions. Every message names the argument or file, the value found and the remedy; the library never prints.
#include <sstream>
#include <stdexcept>
#include <string>

namespace dsns {

/// Base of everything the library throws.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A function was called with arguments outside its contract.
struct InvalidArgument : Error {
  using Error::Error;
};
/// A file cannot be read, parsed or written.
struct FileError : Error {
  using Error::Error;
};
/// A mesh or a sequence is not a closed genus-0 surface and cannot be made one.
struct UnusableMesh : Error {
  using Error::Error;
};
/// A surface has a point where its tangent vectors are dependent.
struct DegenerateSurface : Error {
  using Error::Error;
};

/// The parts of a message, concatenated.
template <class... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Throws E with the concatenated parts.
template <class E = InvalidArgument, class... Parts>
[[noreturn]] void fail(const Parts&... parts) {
  throw E(message(parts...));
}

/// Throws E with the concatenated parts unless the condition holds.
template <class E = InvalidArgument, class... Parts>
inline void require(bool condition, const Parts&... parts) {
  if (!condition) [[unlikely]]
    fail<E>(parts...);
}

}  // namespace dsns
