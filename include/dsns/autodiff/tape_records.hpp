#pragma once
/// What a Tape stores. A place on it is an intermediate result with its value and, after a sweep, its adjoint. Every place
/// has a node: two operands and the derivatives in them. Sums of many products, which networks are made of, have a run
/// besides: it names the operands by first place and stride and takes their values from the tape, so that a term costs no
/// memory.
#include <dsns/autodiff/scalar.hpp>
#include <dsns/core/errors.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace dsns::detail {

/// The operands of a term: two places that are multiplied, or a constant of the tape's and a place. Kept in one number,
/// with the kind in the bits that no place needs, so that the term expected next is recognised by one comparison.
struct Term {
  std::uint64_t bits;

  static constexpr std::uint64_t weighted = std::uint64_t(1) << 63, negative = std::uint64_t(1) << 31;
  static constexpr Term of(std::uint32_t a, std::uint32_t b, std::uint64_t kind) {
    return {(std::uint64_t(a) << 32) | b | kind};
  }
  std::uint32_t a() const { return std::uint32_t(bits >> 32) & 0x7fffffffu; }
  std::uint32_t b() const { return std::uint32_t(bits) & 0x7fffffffu; }
  bool is_weighted() const { return (bits & weighted) != 0; }
  bool is_negative() const { return (bits & negative) != 0; }
};

/// Terms with operands at equal distances, to be added to the place `base`, if there is one.
struct Run {
  std::uint64_t next;    // the term that would continue it
  std::uint64_t stride;  // from term to term, in the number's arithmetic; 0 while there is but one
  Term first;
  std::uint32_t base, place;  // 0: none; not recorded yet
  Run* before;                // the sum's other terms, or null

  static constexpr std::uint64_t none = ~std::uint64_t(0);

  /// Whether the term continues the run; then it is part of it.
  DSNS_INLINE bool extend(Term term) {
    if (next == term.bits) [[likely]] {
      next += stride;
      return true;
    }
    return stride == 0 && second(term);
  }

  std::ptrdiff_t stride_b() const { return std::int32_t(std::uint32_t(stride)); }
  std::ptrdiff_t stride_a() const { return std::int32_t(std::uint32_t((stride - std::uint64_t(stride_b())) >> 32)); }
  std::uint32_t size() const {
    return stride == 0 ? 1 : static_cast<std::uint32_t>(std::int64_t(next - first.bits) / std::int64_t(stride));
  }

 private:
  static constexpr std::uint64_t kind = Term::weighted | Term::negative;

  /// The second term tells the stride.
  [[gnu::noinline]] bool second(Term term) {
    const std::int64_t sa = std::int64_t(term.a()) - first.a(), sb = std::int64_t(term.b()) - first.b();
    if (((term.bits ^ first.bits) & kind) != 0 || (sa == 0 && sb == 0)) return false;
    stride = (std::uint64_t(sa) << 32) + std::uint64_t(sb);
    next = term.bits + stride;
    return true;
  }
};

template <class T>
class TapeRecords {
 public:
  using Place = std::uint32_t;
  using Pullback = std::function<void(std::span<const T> results, std::span<T> operands)>;

  void clear() {
    size_ = nowhere;
    variables_ = nowhere;
    weight_count_ = 0;
    push_weight(T(1));  // of the terms that are no product
    run_count_ = 0;
    runs_.clear();
    functions_.clear();
    adjoints_.clear();
    if (nodes_.empty()) grow();
  }
  std::size_t size() const { return size_ - nowhere; }
  T& value(Place p) { return values_[p]; }
  const T& adjoint(Place p) const { return adjoints_[p]; }
  std::size_t adjoint_count() const { return adjoints_.size(); }

  Place push_variable(const T& w) {
    if (variables_ != size_) return push(w);
    if (size_ == capacity_) [[unlikely]]
      grow();
    values_[size_] = w;  // the sweep stops before: no node
    ++variables_;
    return size_++;
  }
  /// A result w with derivative da in place a, and db in place b.
  DSNS_INLINE Place push(const T& w) { return push(size_ % nowhere, T(0), size_ % nowhere, T(0), w); }
  DSNS_INLINE Place push(Place a, const T& da, const T& w) { return push(a, da, size_ % nowhere, T(0), w); }
  DSNS_INLINE Place push(Place a, const T& da, Place b, const T& db, const T& w) {
    if (size_ == capacity_) [[unlikely]]
      grow();
    nodes_[size_] = {a, b, da, db};
    values_[size_] = w;
    return size_++;
  }

  DSNS_INLINE Place push_weight(const T& w) {
    if (weight_count_ == weight_capacity_) [[unlikely]]
      grow_weights();
    weights_[weight_count_] = w;
    return weight_count_++;
  }
  const T& weight(Place k) const { return weights_[k]; }

  /// The beginning of a sum of base (0: none) and terms, or its continuation by terms that do not fit the run before. It
  /// stays where it is until clear().
  Run& open_run(Place base, Term term, Run* before = nullptr) {
    if (run_count_ == chunks_.size() * chunk) chunks_.push_back(std::make_unique<Run[]>(chunk));
    Run& r = chunks_[run_count_ / chunk][run_count_ % chunk];
    ++run_count_;
    r = Run{Run::none, 0, term, base, 0, before};
    return r;
  }
  /// Records the sum, with value w: one place for all its runs.
  Place close_run(Run& last, const T& w) {
    if (last.stride == 0 && last.before == nullptr) return push_term(last.base, last.first, w);
    const Run* first = &last;
    while (first->before != nullptr) first = first->before;
    const Place p = push(first->base, T(1), w);
    for (Run* r = &last; r != nullptr; r = r->before) {
      r->place = p;
      runs_.push_back(r);
    }
    return p;
  }
  /// base (0: none) plus a term.
  Place push_term(Place base, Term term, const T& w) {
    if (term.is_weighted()) return push(base, T(1), term.b(), weights_[term.a()], w);
    const T sign = T(term.is_negative() ? -1 : 1);
    const Place p = push(term.a(), T(sign * values_[term.b()]), term.b(), T(sign * values_[term.a()]), w);
    return base == 0 ? p : push(base, T(1), p, T(1), w);
  }

  /// Consecutive places for the results of a function that supplies its own pullback. Returns the first.
  Place push_function(std::vector<Place> operands, std::span<const T> results, Pullback pullback) {
    const Place first = size_;
    for (const T& w : results) push(w);
    functions_.push_back({first, static_cast<Place>(results.size()), std::move(operands), std::move(pullback)});
    return first;
  }

  /// Adjoints of all places for the result at `last`, whose own is `seed`.
  void sweep(Place last, const T& seed) {
    adjoints_.assign(size_, T(0));
    adjoints_[last] = seed;
    std::size_t r = runs_.size(), f = functions_.size();
    while (r > 0 && runs_[r - 1]->place > last) --r;
    while (f > 0 && functions_[f - 1].place > last) --f;
    for (Place i = last; i >= variables_;) {
      const Place sum = r > 0 ? runs_[r - 1]->place : 0, function = f > 0 ? functions_[f - 1].place : 0;
      const Place stop = std::max({sum, function, Place(variables_ - 1)});
      back_nodes(i, stop);
      if (stop < variables_) return;
      while (r > 0 && runs_[r - 1]->place == stop) back(*runs_[--r]);
      if (stop == function) back(functions_[--f]);
      back_nodes(stop, stop - 1);
      i = stop - 1;
    }
  }

  std::size_t bytes() const {
    return size_ * (sizeof(Node) + 2 * sizeof(T)) + weight_count_ * sizeof(T) + run_count_ * sizeof(Run) +
           runs_.size() * sizeof(Run*);
  }

 private:
  /// The first places take what nobody asks for, in turn, so that additions to them do not wait for one another. A constant
  /// is at place 0.
  static constexpr Place nowhere = 8;

  struct Node {
    Place a, b;
    T da, db;
  };
  struct Function {
    Place place, results;
    std::vector<Place> operands;
    Pullback pullback;
  };

  /// Nodes last, last - 1, ... down to `stop`, without it.
  void back_nodes(Place last, Place stop) {
    const Node* const nodes = nodes_.data();
    T* const adjoints = adjoints_.data();
    for (Place i = last; i > stop; --i) {
      const Node& n = nodes[i];
      const T w = adjoints[i];
      adjoints[n.a] += w * n.da;
      adjoints[n.b] += w * n.db;
    }
  }

  void back(const Run& run) {
    const T w = run.first.is_negative() ? T(-adjoints_[run.place]) : T(adjoints_[run.place]);
    const std::ptrdiff_t n = run.size(), sa = run.stride_a(), sb = run.stride_b();
    const Place a = run.first.a(), b = run.first.b();
    if (run.first.is_weighted()) {
      add_multiple(adjoints_.data() + b, sb, w, weights_.data() + a, sa, n);
    } else {
      add_multiple(adjoints_.data() + a, sa, w, values_.data() + b, sb, n);
      add_multiple(adjoints_.data() + b, sb, w, values_.data() + a, sa, n);
    }
  }
  /// y += w x, with strides; x and y are different arrays.
  static void add_multiple(T* __restrict y, std::ptrdiff_t sy, const T& w, const T* __restrict x, std::ptrdiff_t sx,
                           std::ptrdiff_t n) {
    if (sx == 1 && sy == 1)
      for (std::ptrdiff_t k = 0; k < n; ++k) y[k] += w * x[k];
    else if (sy == 1)
      for (std::ptrdiff_t k = 0; k < n; ++k) y[k] += w * x[k * sx];
    else
      for (std::ptrdiff_t k = 0; k < n; ++k) y[k * sy] += w * x[k * sx];
  }

  void back(const Function& f) {
    const std::vector<T> results(adjoints_.begin() + f.place, adjoints_.begin() + f.place + f.results);
    std::vector<T> operands(f.operands.size(), T(0));
    f.pullback(results, operands);
    for (std::size_t k = 0; k < operands.size(); ++k) adjoints_[f.operands[k]] += operands[k];
  }

  [[gnu::noinline]] void grow() {
    const std::size_t capacity = nodes_.empty() ? 256 : 2 * nodes_.size();
    if (capacity > most) throw InvalidArgument("Tape: more than 2^30 operations in one recording");
    nodes_.resize(capacity);
    values_.resize(capacity);
    capacity_ = static_cast<Place>(capacity);
  }
  [[gnu::noinline]] void grow_weights() {
    if (2 * weights_.size() > most) throw InvalidArgument("Tape: more than 2^30 constant factors in one recording");
    weights_.resize(std::max<std::size_t>(256, 2 * weights_.size()));
    weight_capacity_ = static_cast<Place>(weights_.size());
  }

  std::vector<Node> nodes_;  // and values_: capacity_ of them, size_ in use
  std::vector<T> values_;
  Place size_ = nowhere, capacity_ = 0;
  Place variables_ = nowhere;  // the places before this are independent variables
  std::vector<T> weights_;     // weight_count_ in use
  Place weight_count_ = 0, weight_capacity_ = 0;
  std::vector<T> adjoints_;
  static constexpr std::size_t most = std::size_t(1) << 30;  // so that no place plus a stride is another kind of Term
  static constexpr std::size_t chunk = 512;
  std::vector<std::unique_ptr<Run[]>> chunks_;  // of runs, run_count_ in use
  std::size_t run_count_ = 0;
  std::vector<const Run*> runs_;  // those recorded, by place
  std::vector<Function> functions_;
};

}  // namespace dsns::detail
