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
#include <dsns/autodiff/tape_records.hpp>
#include <dsns/autodiff/var.hpp>
#include <dsns/core/errors.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace dsns {

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
    ~Recording() {
      active_ = previous_;
      top_ = below_;
      // The outer recording may have been replaced by one on the same tape.
      const bool replaced = previous_ != nullptr && previous_->recording_ != previous_recording_;
      active_recording_ = replaced ? 1 : previous_recording_;
    }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

   private:
    friend class Tape;
    explicit Recording(Tape& tape) : previous_(active_), previous_recording_(active_recording_), below_(top_) {
      active_ = &tape;
      active_recording_ = tape.recording_;
      top_ = this;
    }

    Tape* previous_;
    std::uint64_t previous_recording_;
    Recording* below_;
  };

  /// Forgets the last recording, keeps its memory, and becomes the active tape of this thread.
  Recording record() {
    records_.clear();
    do recording_ = last_recording_.fetch_add(1, std::memory_order_relaxed);
    while (recording_ < 2);
    return Recording(*this);
  }
  /// An independent variable of this recording.
  /// throws   InvalidArgument before the first recording
  Var<T> variable(const T& w) {
    if (recording_ == 0) [[unlikely]]
      throw InvalidArgument("Tape::variable: there is no recording; keep what record() returns while you compute");
    return Var<T>(w, Var<T>::recorded(recording_, records_.push_variable(w)));
  }

  /// Derivatives of `seed * result` in everything recorded before it; replaces the adjoints of an earlier sweep.
  /// throws   InvalidArgument for a result of another recording
  void backward(const Var<T>& result, const T& seed = T(1)) {
    if (!result.t_.is_constant()) check(result);
    if (!result.t_.settled()) result.t_ = Var<T>::recorded(recording_, Var<T>::place_on(records_, result.t_, result.f));
    ++sweeps_;
    records_.sweep(result.t_.place(), seed);
  }
  /// The derivative of the last sweep's result in x; 0 for a constant, and for a product or sum of which nothing was made.
  /// throws   InvalidArgument for a variable of another recording, or recorded after the sweep
  T adjoint(const Var<T>& x) const {
    if (x.t_.is_constant()) return T(0);
    check(x);
    if (!x.t_.settled()) return T(0);  // nothing was made of it
    const std::uint32_t place = x.t_.place();
    if (place >= records_.adjoint_count()) [[unlikely]]
      throw InvalidArgument("Tape::adjoint: the variable is younger than the last backward sweep");
    return records_.adjoint(place);
  }
  /// What a function's pullback gets and gives: the derivatives of the sweep's result in the function's results; to
  /// `operands` it adds those in its operands.
  using Pullback = std::function<void(std::span<const T> results, std::span<T> operands)>;
  /// The results of a function that brings its own derivative, on the active tape; constants if all operands are. The
  /// pullback lives as long as the recording.
  static std::vector<Var<T>> function(std::span<const Var<T>> operands, std::span<const T> results, Pullback pullback) {
    std::vector<std::uint32_t> places;
    std::uint64_t recording = 0;
    for (const Var<T>& x : operands) {
      x.settle();
      if (!x.t_.is_constant()) {
        require(recording == 0 || recording == x.t_.recording(), "Tape::function: operands of different recordings");
        recording = x.t_.recording();
      }
      places.push_back(x.t_.place());
    }
    if (recording == 0) return {results.begin(), results.end()};
    return active_->variables(active(recording).push_function(std::move(places), results, std::move(pullback)),
                              results);
  }
  /// Results of something that is not on the tape, such as a matrix of a MatrixTape, as variables of this recording. The
  /// sweep calls `back` with the derivatives in them, after it has done with all that was recorded later; without results
  /// it is a step of the sweep and nothing else.
  /// throws   InvalidArgument unless the recording is the active one of this thread
  std::vector<Var<T>> external(std::span<const T> results, std::function<void(std::span<const T>)> back) {
    const T none(0);
    const std::uint32_t first = active(recording_)
                                    .push_function({}, results.empty() ? std::span<const T>(&none, 1) : results,
                                                   [back = std::move(back)](std::span<const T> derivatives,
                                                                            std::span<T>) { back(derivatives); });
    return variables(first, results);
  }
  /// throws   InvalidArgument unless the recording is the active one of this thread
  void check_active() const {
    if (!is_active(recording_)) [[unlikely]]
      inactive();
  }
  /// Identity of the recording, and the number of backward sweeps so far.
  std::uint64_t recording() const { return recording_; }
  std::size_t sweeps() const { return sweeps_; }
  /// Operations and variables recorded.
  std::size_t size() const { return records_.size(); }
  /// Memory in use by this recording and its adjoints.
  std::size_t bytes() const { return records_.bytes(); }

 private:
  friend struct Var<T>;

  DSNS_INLINE static detail::TapeRecords<T>& active(std::uint64_t recording) {
    if (!is_active(recording)) [[unlikely]]
      inactive();
    return active_->records_;
  }
  /// Also false for whatever is not in the state `exact`.
  DSNS_INLINE static bool is_active(std::uint64_t recording) { return recording == active_recording_; }
  /// That of any recording that lives on this thread, also beneath the active one: a variable may be copied there.
  static detail::TapeRecords<T>& alive(std::uint64_t recording) {
    if (is_active(recording)) return active_->records_;
    for (const Recording* r = top_; r != nullptr; r = r->below_)
      if (r->previous_ != nullptr && r->previous_->recording_ == recording) return r->previous_->records_;
    inactive();
  }
  [[noreturn, gnu::cold]] static void inactive() {
    throw InvalidArgument("Var: its recording is not the active one of this thread; it has ended or was replaced");
  }
  void check(const Var<T>& x) const {
    if (x.t_.recording() != recording_) [[unlikely]]
      throw InvalidArgument("Tape: the variable does not belong to this tape's last recording");
  }

  std::vector<Var<T>> variables(std::uint32_t first, std::span<const T> values) const {
    std::vector<Var<T>> out;
    out.reserve(values.size());
    for (const T& w : values) out.push_back(Var<T>(w, Var<T>::recorded(recording_, first++)));
    return out;
  }

  static inline std::atomic<std::uint32_t> last_recording_{2};
  static inline constinit thread_local Tape* active_ = nullptr;
  static inline constinit thread_local Recording* top_ = nullptr;
  static inline constinit thread_local std::uint64_t active_recording_ =
      1;  // that on it; 1 is nobody's, 0 that of constants

  detail::TapeRecords<T> records_;
  std::uint32_t recording_ = 0;
  std::size_t sweeps_ = 0;
};

}  // namespace dsns
