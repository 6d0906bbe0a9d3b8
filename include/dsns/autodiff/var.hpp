#pragma once
/// The variables of reverse mode. They are of use with a Tape: include dsns/autodiff/tape.hpp.
#include <dsns/autodiff/functions.hpp>
#include <dsns/autodiff/tape_records.hpp>
#include <dsns/core/errors.hpp>

#include <compare>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace dsns {

template <class T>
class Tape;

namespace detail {

/// What a variable is besides its value. Small enough to be passed in registers.
struct VarTerms {
  // States, in the upper half of the tag; the lower is the recording.
  static constexpr std::uint64_t exact = 0;                      // a constant, or recorded with this value
  static constexpr std::uint64_t term = std::uint64_t(2) << 32;  // not recorded: a Term
  static constexpr std::uint64_t open = std::uint64_t(3) << 32;  // not recorded: a Run, to which terms may be added

  std::uint64_t operands = 0;  // the place, the Term or the address of the Run
  std::uint64_t tag = 0;       // 0 is a constant

  std::uint64_t recording() const { return tag & 0xffffffffu; }
  std::uint64_t state() const { return tag & ~std::uint64_t(0xffffffffu); }
  std::uint32_t place() const { return static_cast<std::uint32_t>(operands); }
  Run& run() const { return *reinterpret_cast<Run*>(operands); }
  bool is_constant() const { return tag == 0; }
  bool settled() const { return tag < term; }
  /// The same place under a name of its own: a term with the tape's constant 0, which is 1.
  VarTerms renamed() const { return {Term::of(0, place(), Term::weighted).bits, tag | term}; }
};

}  // namespace detail

/// A value on a tape. T may be an arithmetic type or a forward scalar (Var<Dual<double>> differentiates the gradient).
///
/// A product is not recorded when it is computed: the variable carries its factors, and records it when it is first used as
/// an operand, or copied. Added by += to a sum that has not been used yet, it becomes a term of the sum's run instead.
/// Operators take their operands by value, so that a temporary hands its factors on and a named variable has been recorded
/// (by the copy).
template <class T>
struct Var {
  using Inner = T;

  T f;

  Var() : f(T(0)) {}
  /// A constant.
  template <class S>
  requires(std::is_arithmetic_v<S> || std::is_same_v<S, T> || PassiveFor<S, T>) DSNS_INLINE Var(const S& s)
      : f(static_cast<T>(s)) {}
  DSNS_INLINE Var(const Var& x) : f(x.f) {
    x.settle();
    t_ = x.t_;
  }
  DSNS_INLINE Var& operator=(const Var& x) {
    x.settle();
    f = x.f;
    t_ = x.t_;
    return *this;
  }
  DSNS_INLINE Var(Var&& x) {
    x.close();
    f = x.f;
    t_ = x.t_;
  }
  DSNS_INLINE Var& operator=(Var&& x) {
    x.close();
    f = x.f;
    t_ = x.t_;
    return *this;
  }
  ~Var() = default;

  /// w(x) for a function with value w and derivative d at x.f.
  template <class Second>
  DSNS_INLINE friend Var chain(const Var& x, const T& w, const T& d, const Second&) {
    x.settle();
    return Var(w, push(x.t_, d, w));
  }
  /// w(x, y) for a function with value w and partial derivatives wx, wy.
  template <class Second>
  DSNS_INLINE friend Var chain(const Var& x, const Var& y, const T& w, const T& wx, const T& wy, const Second&) {
    if (exact_and_active(x.t_) && exact_and_active(y.t_)) [[likely]]
      return Var(w, recorded(x.t_.tag, records(x.t_).push(x.t_.place(), wx, y.t_.place(), wy, w)));
    x.settle();
    y.settle();
    return Var(w, push(x.t_, wx, y.t_, wy, w));
  }
  /// a where the mask holds, else b, for T over a Batch.
  template <class M>
  requires(!std::is_convertible_v<M, bool>) friend Var select(const M& mask, const Var& a, const Var& b) {
    return chain(a, b, T(select(mask, a.f, b.f)), T(select(mask, T(1), T(0))), T(select(mask, T(0), T(1))), none);
  }
  friend bool derivatives_vanish(const Var& x) { return x.t_.is_constant() && detail::inert(x.f); }

  friend Var operator+(Var a) { return a; }
  DSNS_INLINE friend Var operator-(Var a) {
    a.negate();
    return a;
  }
  DSNS_INLINE friend Var operator+(Var a, Var b) {
    const T w = a.f + b.f;
    return Var(w, sum(a.t_, b.t_, false, a.f, b.f, w));
  }
  DSNS_INLINE friend Var operator-(Var a, Var b) {
    const T w = a.f - b.f;
    return Var(w, sum(a.t_, b.t_, true, a.f, b.f, w));
  }
  DSNS_INLINE friend Var operator*(Var a, Var b) {
    const T w = a.f * b.f;
    if (exact_and_active(a.t_) && exact_and_active(b.t_)) [[likely]]
      return Var(w, {(a.t_.operands << 32) | b.t_.operands, a.t_.tag | Terms::term});
    return Var(w, general_product(a.t_, b.t_, a.f, b.f));
  }
  friend Var operator/(const Var& a, const Var& b) {
    const T inverse = 1 / b.f, q = a.f / b.f;
    return chain(a, b, q, inverse, -q * inverse, none);
  }

  template <PassiveFor<Var> S>
  DSNS_INLINE friend Var operator+(Var a, const S& s) {
    a.shift(a.f + detail::constant<Var>(s));
    return a;
  }
  template <PassiveFor<Var> S>
  DSNS_INLINE friend Var operator+(const S& s, Var a) {
    a.shift(a.f + detail::constant<Var>(s));
    return a;
  }
  template <PassiveFor<Var> S>
  DSNS_INLINE friend Var operator-(Var a, const S& s) {
    a.shift(a.f - detail::constant<Var>(s));
    return a;
  }
  template <PassiveFor<Var> S>
  DSNS_INLINE friend Var operator-(const S& s, Var a) {
    const T w = detail::constant<Var>(s) - a.f;
    a.negate();
    a.shift(w);
    return a;
  }
  template <PassiveFor<Var> S>
  DSNS_INLINE friend Var operator*(Var a, const S& s) {
    const T c = detail::constant<Var>(s);
    a.scale(a.f * c, c);
    return a;
  }
  template <PassiveFor<Var> S>
  DSNS_INLINE friend Var operator*(const S& s, Var a) {
    const T c = detail::constant<Var>(s);
    a.scale(a.f * c, c);
    return a;
  }
  template <PassiveFor<Var> S>
  DSNS_INLINE friend Var operator/(Var a, const S& s) {
    const T c = detail::constant<Var>(s);
    a.scale(a.f / c, 1 / c);
    return a;
  }
  template <PassiveFor<Var> S>
  friend Var operator/(const S& s, const Var& a) {
    const T q = detail::constant<Var>(s) / a.f;
    return chain(a, q, -q / a.f, none);
  }

  DSNS_INLINE Var& operator+=(Var b) {
    accumulate(b.t_, false, b.f, f + b.f);
    return *this;
  }
  DSNS_INLINE Var& operator-=(Var b) {
    accumulate(b.t_, true, b.f, f - b.f);
    return *this;
  }
  DSNS_INLINE Var& operator*=(Var b) { return *this = Var(*this) * std::move(b); }
  Var& operator/=(const Var& b) { return *this = *this / b; }

  /// Comparisons see values only.
  friend detail::Equality<T> operator==(const Var& a, const Var& b) { return a.f == b.f; }
  friend auto operator<=>(const Var& a, const Var& b) { return a.f <=> b.f; }
  template <PassiveFor<Var> S>
  friend detail::Equality<T> operator==(const Var& a, const S& s) {
    return a.f == detail::constant<Var>(s);
  }
  template <PassiveFor<Var> S>
  friend auto operator<=>(const Var& a, const S& s) {
    return a.f <=> detail::constant<Var>(s);
  }

 private:
  friend class Tape<T>;
  using Terms = detail::VarTerms;
  using Term = detail::Term;
  /// Numbers by value: the address of a variable that is passed on keeps it from registers.
  using Argument = std::conditional_t<std::is_arithmetic_v<T>, T, const T&>;
  static constexpr auto none = [] {};

  mutable Terms t_;

  DSNS_INLINE Var(const T& w, const Terms& t) : f(w), t_(t) {}

  DSNS_INLINE static auto& records(const Terms& t) { return Tape<T>::active(t.recording()); }
  DSNS_INLINE static Terms recorded(std::uint64_t recording, std::uint32_t place) { return {place, recording}; }
  DSNS_INLINE static bool exact_and_active(const Terms& t) {
    if (!Tape<T>::is_active(t.tag)) return false;
    if (t.state() != 0) DSNS_UNREACHABLE;
    return true;
  }

  DSNS_INLINE void settle() const {
    if (!t_.settled()) [[unlikely]]
      t_ = recorded(t_.recording(), place_of(t_, f));
  }
  /// A sum has one owner, who may add to it.
  DSNS_INLINE void close() const {
    if (t_.tag >= Terms::open) [[unlikely]]
      t_ = recorded(t_.recording(), place_of(t_, f));
  }
  /// The place of terms with value w, recorded now where they have none.
  [[gnu::noinline]] static std::uint32_t place_of(Terms t, Argument w) {
    return t.settled() ? t.place() : place_on(Tape<T>::alive(t.recording()), t, w);
  }
  static std::uint32_t place_on(detail::TapeRecords<T>& tape, const Terms& t, const T& w) {
    return t.state() == Terms::open ? tape.close_run(t.run(), w) : tape.push_term(0, Term{t.operands}, w);
  }

  /// A result w with derivative d in the settled x, or with wx and wy in x and y; they may be constants.
  [[gnu::noinline]] static Terms push(Terms x, Argument d, Argument w) {
    if (x.is_constant()) return x;
    return recorded(x.recording(), records(x).push(x.place(), d, w));
  }
  [[gnu::noinline]] static Terms push(Terms x, Argument wx, Terms y, Argument wy, Argument w) {
    if (x.is_constant() && y.is_constant()) return x;
    const Terms& active = x.is_constant() ? y : x;
    check(x, y);
    return recorded(active.recording(), records(active).push(x.place(), wx, y.place(), wy, w));
  }
  DSNS_INLINE static void check(const Terms& x, const Terms& y) {
    if (x.recording() != y.recording() && !x.is_constant() && !y.is_constant()) [[unlikely]]
      mixed();
  }
  [[noreturn, gnu::cold]] static void mixed() {
    throw InvalidArgument("Var: the operands belong to different recordings");
  }

  /// The terms of x +- y, whose value is w.
  DSNS_INLINE static Terms sum(const Terms& x, const Terms& y, bool negative, const T& xf, const T& yf, const T& w) {
    if (!exact_and_active(x) || !exact_and_active(y)) return general_sum(x, y, negative, xf, yf, w);
    return recorded(x.tag, records(x).push(x.place(), T(1), y.place(), T(negative ? -1 : 1), w));
  }
  [[gnu::noinline]] static Terms general_sum(Terms x, Terms y, bool negative, Argument xf, Argument yf, Argument w) {
    if (y.is_constant()) return shifted(x, xf);
    if (x.is_constant()) return negative ? scaled(y, yf, T(-1)) : shifted(y, yf);
    check(x, y);
    const Linear a = linear(x, xf), b = linear(y, yf);
    return recorded(x.recording(), records(x).push(a.place, a.weight, b.place, negative ? T(-b.weight) : b.weight, w));
  }

  /// Adds +- y, of value yf, in place; w is the new value.
  DSNS_INLINE void accumulate(const Terms& y, bool negative, const T& yf, const T& w) {
    if (y.state() == Terms::term && !(negative && Term{y.operands}.is_weighted())) {
      const Term term{negative ? y.operands ^ Term::negative : y.operands};
      if (t_.tag != (y.tag | Terms::open) || !Tape<T>::is_active(y.tag - Terms::term) || !t_.run().extend(term))
          [[unlikely]]
        t_ = opened(t_, y, term, f);
    } else if (!negative && !t_.is_constant() && exact_and_active(y)) {
      const Term term{y.renamed().operands};
      if (t_.tag != (y.tag | Terms::open) || !t_.run().extend(term)) t_ = opened(t_, y, term, f);
    } else {
      t_ = sum(t_, y, negative, f, yf, w);
    }
    f = w;
  }
  /// A sum of x and the term y, which does not continue x as it is.
  [[gnu::noinline]] static Terms opened(Terms x, Terms y, Term term, Argument xf) {
    check(x, y);
    auto& tape = records(y);
    detail::Run* run = nullptr;
    if (x.state() == Terms::open) {
      run = &tape.open_run(0, term, &x.run());
    } else if (x.state() == Terms::term) {
      run = &tape.open_run(0, Term{x.operands});
      if (!run->extend(term)) run = &tape.open_run(0, term, run);
    } else {
      run = &tape.open_run(x.is_constant() ? 0 : place_of(x, xf), term);
    }
    return {reinterpret_cast<std::uint64_t>(run), y.recording() | Terms::open};
  }

  /// The terms x of value w, to which a constant will have been added: a variable of its own.
  DSNS_INLINE static Terms shifted(const Terms& x, const T& w) {
    if (x.is_constant() || x.state() == Terms::term) return x;
    return recorded(x.recording(), place_of(x, w)).renamed();
  }
  DSNS_INLINE void shift(const T& w) {
    t_ = shifted(t_, f);
    f = w;
  }
  DSNS_INLINE void negate() {
    if (t_.state() == Terms::term && !Term{t_.operands}.is_weighted())
      t_.operands ^= Term::negative;
    else
      t_ = scaled(t_, f, T(-1));
    f = -f;
  }
  /// The value becomes w, the derivatives c times what they are.
  DSNS_INLINE void scale(const T& w, const T& c) {
    t_ = scaled(t_, f, c);
    f = w;
  }
  /// c times terms t of value w.
  DSNS_INLINE static Terms scaled(const Terms& t, const T& w, const T& c) {
    if (exact_and_active(t)) [[likely]]
      return {Term::of(records(t).push_weight(c), t.place(), Term::weighted).bits, t.tag | Terms::term};
    return general_scaled(t, w, c);
  }
  [[gnu::noinline]] static Terms general_scaled(Terms t, Argument w, Argument c) {
    if (t.is_constant()) return t;
    auto& tape = records(t);
    const Linear l = linear(t, w);
    return {Term::of(tape.push_weight(T(l.weight * c)), l.place, Term::weighted).bits, t.recording() | Terms::term};
  }

  struct Linear {
    std::uint32_t place;
    T weight;
  };
  /// The terms t of value w as a weight times a recorded place.
  static Linear linear(const Terms& t, const T& w) {
    const Term term{t.operands};
    if (t.state() == Terms::term && term.is_weighted()) return {term.b(), records(t).weight(term.a())};
    if (t.state() == Terms::term && term.a() == term.b()) {
      const T x = records(t).value(term.a());
      return {term.a(), term.is_negative() ? T(-(x + x)) : T(x + x)};
    }
    return {place_of(t, w), T(1)};
  }
  [[gnu::noinline]] static Terms general_product(Terms a, Terms b, Argument af, Argument bf) {
    if (b.is_constant()) return general_scaled(a, af, bf);
    if (a.is_constant()) return general_scaled(b, bf, af);
    check(a, b);
    const Linear x = linear(a, af), y = linear(b, bf);
    return recorded(a.recording(), records(a).push(x.place, T(x.weight * bf), y.place, T(y.weight * af), T(af * bf)));
  }
};

template <class T>
inline constexpr bool is_differentiable<Var<T>> = true;

}  // namespace dsns
