#pragma once
/// Reverse automatic differentiation: operations on Var are recorded on a Tape, one backward sweep gives the
/// derivatives of one result in all variables. Needs no Eigen. Var is a plain value: `auto` is safe.
///
///   Tape<double> tape;
///   const auto recording = tape.record();            // active on this thread until `recording` ends
///   const auto x = tape.variable(2), y = tape.variable(3);
///   const auto z = x * sin(y);
///   tape.backward(z);
///   tape.adjoint(x);                                 // dz/dx
///
/// Cost is linear in the number of operations, also where results are shared; nothing recurses. A tape keeps its memory
/// from one recording to the next. Tapes of different threads are independent.
#include <dsns/autodiff/functions.hpp>
#include <dsns/core/errors.hpp>

#include <algorithm>
#include <atomic>
#include <compare>
#include <cstdint>
#include <limits>
#include <vector>

namespace dsns {

template <class T>
class Tape;

/// A value on a tape. T may be an arithmetic type or a forward scalar (Var<Dual<double>> differentiates the gradient).
template <class T>
struct Var {
  using Inner = T;

  T f;
  std::uint32_t node = 0;       ///< place on the tape; 0 is a constant
  std::uint32_t recording = 0;  ///< which recording the place belongs to

  Var() : f(T(0)) {}
  /// A constant.
  template <class S>
  requires(std::is_arithmetic_v<S> || std::is_same_v<S, T> || PassiveFor<S, T>) Var(const S& s)
      : f(static_cast<T>(s)) {}

  /// w(x) for a function with value w and derivative d at x.f.
  template <class Second>
  friend Var chain(const Var& x, const T& w, const T& d, const Second&) {
    return x.node == 0 ? Var(w) : Tape<T>::operation(w, x, d);
  }
  /// w(x, y) for a function with value w and partial derivatives wx, wy.
  template <class Second>
  friend Var chain(const Var& x, const Var& y, const T& w, const T& wx, const T& wy, const Second&) {
    if (x.node == 0) return y.node == 0 ? Var(w) : Tape<T>::operation(w, y, wy);
    return y.node == 0 ? Tape<T>::operation(w, x, wx) : Tape<T>::operation(w, x, wx, y, wy);
  }
  friend bool derivatives_vanish(const Var& x) { return x.node == 0 && detail::inert(x.f); }

  friend Var operator+(const Var& a) { return a; }
  friend Var operator-(const Var& a) { return chain(a, -a.f, T(-1), none); }
  friend Var operator+(const Var& a, const Var& b) { return chain(a, b, a.f + b.f, T(1), T(1), none); }
  friend Var operator-(const Var& a, const Var& b) { return chain(a, b, a.f - b.f, T(1), T(-1), none); }
  friend Var operator*(const Var& a, const Var& b) { return chain(a, b, a.f * b.f, b.f, a.f, none); }
  friend Var operator/(const Var& a, const Var& b) {
    const T inverse = 1 / b.f, q = a.f / b.f;
    return chain(a, b, q, inverse, -q * inverse, none);
  }

  template <PassiveFor<Var> S>
  friend Var operator+(const Var& a, const S& s) {
    return a.shifted(a.f + detail::constant<Var>(s));
  }
  template <PassiveFor<Var> S>
  friend Var operator+(const S& s, const Var& a) {
    return a + s;
  }
  template <PassiveFor<Var> S>
  friend Var operator-(const Var& a, const S& s) {
    return a.shifted(a.f - detail::constant<Var>(s));
  }
  template <PassiveFor<Var> S>
  friend Var operator-(const S& s, const Var& a) {
    return chain(a, detail::constant<Var>(s) - a.f, T(-1), none);
  }
  template <PassiveFor<Var> S>
  friend Var operator*(const Var& a, const S& s) {
    const T c = detail::constant<Var>(s);
    return chain(a, a.f * c, c, none);
  }
  template <PassiveFor<Var> S>
  friend Var operator*(const S& s, const Var& a) {
    return a * s;
  }
  template <PassiveFor<Var> S>
  friend Var operator/(const Var& a, const S& s) {
    const T c = detail::constant<Var>(s);
    return chain(a, a.f / c, 1 / c, none);
  }
  template <PassiveFor<Var> S>
  friend Var operator/(const S& s, const Var& a) {
    const T q = detail::constant<Var>(s) / a.f;
    return chain(a, q, -q / a.f, none);
  }

  Var& operator+=(const Var& b) { return *this = *this + b; }
  Var& operator-=(const Var& b) { return *this = *this - b; }
  Var& operator*=(const Var& b) { return *this = *this * b; }
  Var& operator/=(const Var& b) { return *this = *this / b; }

  /// Comparisons see values only.
  friend bool operator==(const Var& a, const Var& b) { return a.f == b.f; }
  friend auto operator<=>(const Var& a, const Var& b) { return a.f <=> b.f; }
  template <PassiveFor<Var> S>
  friend bool operator==(const Var& a, const S& s) {
    return a.f == detail::constant<Var>(s);
  }
  template <PassiveFor<Var> S>
  friend auto operator<=>(const Var& a, const S& s) {
    return a.f <=> detail::constant<Var>(s);
  }

 private:
  static constexpr auto none = [] {};
  /// The same place on the tape with another value: adding a constant needs no operation of its own.
  Var shifted(const T& w) const {
    Var r = *this;
    r.f = w;
    return r;
  }
};

template <class T>
inline constexpr bool is_differentiable<Var<T>> = true;

/// The record of one computation. Not copied, not moved: variables and threads refer to it.
template <class T>
class Tape {
 public:
  Tape() = default;
  Tape(const Tape&) = delete;
  Tape& operator=(const Tape&) = delete;

  /// While it lives, this thread's operations on Var<T> go to its tape; afterwards to the tape that was active before.
  class [[nodiscard]] Recording {
   public:
    explicit Recording(Tape& tape) : previous_(active_) { active_ = &tape; }
    ~Recording() { active_ = previous_; }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

   private:
    Tape* previous_;
  };

  /// Forgets the last recording, keeps its memory, and becomes the active tape of this thread.
  Recording record() {
    nodes_.resize(1);
    recording_ = ++last_recording_;
    return Recording(*this);
  }
  /// An independent variable of this recording.
  Var<T> variable(const T& w) { return add(w, {0, 0, T(0), T(0)}); }

  /// Derivatives of `seed * result` in everything recorded before it; replaces the adjoints of an earlier sweep.
  /// throws   InvalidArgument for a result of another recording
  void backward(const Var<T>& result, const T& seed = T(1)) {
    adjoints_.assign(nodes_.size(), T(0));
    if (result.node == 0) return;
    check(result);
    adjoints_[result.node] = seed;
    for (std::size_t i = result.node; i > 0; --i) {
      const Node& n = nodes_[i];
      const T w = adjoints_[i];
      adjoints_[n.a] += w * n.da;
      adjoints_[n.b] += w * n.db;
    }
  }
  /// The derivative of the last sweep's result in x; 0 for a constant.
  /// throws   InvalidArgument for a variable of another recording, or recorded after the sweep
  T adjoint(const Var<T>& x) const {
    if (x.node == 0) return T(0);
    check(x);
    require(x.node < adjoints_.size(), "Tape::adjoint: the variable is younger than the last backward sweep");
    return adjoints_[x.node];
  }
  /// The result w of an operation on x (and y) with the given partial derivatives, recorded on the active tape.
  /// throws   InvalidArgument for operands of a recording that is not the active one
  static Var<T> operation(const T& w, const Var<T>& x, const T& d) { return of(x).add(w, {x.node, 0, d, T(0)}); }
  static Var<T> operation(const T& w, const Var<T>& x, const T& dx, const Var<T>& y, const T& dy) {
    require(x.recording == y.recording, "Var: the operands belong to different recordings");
    return of(x).add(w, {x.node, y.node, dx, dy});
  }
  /// Operations and variables recorded.
  std::size_t size() const { return nodes_.size() - 1; }

 private:
  struct Node {
    std::uint32_t a, b;  // operands; 0 takes what nobody asks for
    T da, db;
  };

  static Tape& of(const Var<T>& x) {
    if (active_ == nullptr || active_->recording_ != x.recording) [[unlikely]]
      throw InvalidArgument("Var: its recording is not the active one of this thread; it has ended or was replaced");
    return *active_;
  }
  Var<T> add(const T& w, const Node& n) {
    if (nodes_.size() == std::numeric_limits<std::uint32_t>::max()) [[unlikely]]
      throw InvalidArgument("Tape: more than 2^32 operations in one recording");
    Var<T> r(w);
    r.node = static_cast<std::uint32_t>(nodes_.size());
    r.recording = recording_;
    nodes_.push_back(n);
    return r;
  }
  void check(const Var<T>& x) const {
    require(x.recording == recording_, "Tape: the variable does not belong to this tape's last recording");
  }

  static inline std::atomic<std::uint32_t> last_recording_{0};
  static inline constinit thread_local Tape* active_ = nullptr;

  std::vector<Node> nodes_{1};
  std::vector<T> adjoints_;
  std::uint32_t recording_ = 0;
};

}  // namespace dsns
