#pragma once
/// How adapters hold what they adapt: an lvalue is referred to, and must outlive the adapter; an rvalue is kept by value.
#include <type_traits>
#include <utility>

namespace dsns::detail {

/// The template argument of an adapter made of an S&&: `const F&` where it refers, F where it keeps.
template <class S>
using HeldAs =
    std::conditional_t<std::is_lvalue_reference_v<S>, const std::remove_reference_t<S>&, std::remove_cvref_t<S>>;

template <class S>
class Held {
 public:
  explicit Held(S surface) : surface_(std::move(surface)) {}
  const S& operator*() const { return surface_; }

 private:
  S surface_;
};
template <class S>
class Held<const S&> {
 public:
  explicit Held(const S& surface) : surface_(&surface) {}
  const S& operator*() const { return *surface_; }

 private:
  const S* surface_;
};

}  // namespace dsns::detail
