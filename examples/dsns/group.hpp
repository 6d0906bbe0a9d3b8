#pragma once
/// The animations of a group: read, mapped and fitted on several threads, held in memory or, where a work folder is given, in files
/// there, from which an interrupted run goes on.
#include "bodies.hpp"

#include <dsns/stats/registration_archive.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace dsns::program {

class Group {
 public:
  /// Says what was done to each and which cannot be used, all of them: then it throws, or leaves them out where the settings let
  /// it and `least` remain.
  Group(const std::vector<std::string>& sources, const Settings& settings, Report& report, std::size_t least);
  /// Of bodies that are at hand.
  explicit Group(std::vector<Body> bodies);

  /// What is known of a member without its shape.
  struct Member {
    std::string source;  ///< as it was named
    std::string name;    ///< file and clip, for people
    std::filesystem::path file;
    Mat3X trajectory;  ///< see NormalizedSequence
    double scale = 1, duration = 1;
    std::size_t place = 0;       ///< among the sources named, those left out counted
    std::uint64_t key = 0;       ///< of the file's bytes and of all settings that bear on the body
    std::filesystem::path kept;  ///< its file in the work folder, or empty
  };
  const std::vector<Member>& members() const { return members_; }
  std::size_t size() const { return members_.size(); }
  /// How many sources were named.
  std::size_t given() const { return given_; }
  /// The body, from its file where it is kept in one: then without what hangs it on the mesh of its source.
  Body body(std::size_t i) const;
  AnyAnimatedSurface surface(std::size_t i) const;
  /// Keeps in the work folder, if there is one. `what` and the members' keys make the names: other options, other files.
  ResultStore store(std::size_t chosen, const std::string& what) const;

 private:
  std::filesystem::path folder_;
  std::vector<Member> members_;
  std::vector<Body> bodies_;  ///< empty where they are kept in files
  std::size_t given_ = 0;
};

}  // namespace dsns::program
