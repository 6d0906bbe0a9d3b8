#include "group.hpp"

#include "checkpoint.hpp"
#include "fits.hpp"

#include <dsns/core/checksum.hpp>
#include <dsns/core/parallel.hpp>
#include <dsns/io/archive_file.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/surface/sampled.hpp>

#include <algorithm>
#include <iostream>
#include <mutex>
#include <optional>

namespace dsns::program {

namespace {

namespace fs = std::filesystem;

/// Changes where a file that is kept would no longer be what this program makes.
constexpr int kept_version = 1;

std::uint64_t key_of_files(const fs::path& file) {
  if (!fs::is_directory(file)) return fs::exists(file) ? xxh64(detail::read_whole_file(file)) : 0;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(file))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string all;
  for (const auto& path : files) all += message(path.filename().string(), " ", key_of_files(path), "\n");
  return xxh64(all);
}

/// Of the bytes and of the settings that bear on a body.
std::uint64_t key_of_source(const std::string& name, const Settings& s) {
  const SourceName source = parse_source(name);
  std::string all = message(kept_version, "|", key_of_files(source.file), "|", source.clip, "|", s.frames, "|", s.rate,
                            "|", s.node, "|", s.repair.piece, "|", s.join, "|");
  if (!s.faces.empty()) all += message(key_of_files(s.faces));
  if (s.representation == Representation::neural)
    all += message("|", int(s.preset), "|", s.steps, "|", s.seconds, "|", s.target_msd, "|", s.seed);
  return xxh64(all);
}

std::string hexadecimal(std::uint64_t key) {
  std::string out(16, '0');
  for (std::size_t k = 0; k < 16; ++k) out[15 - k] = "0123456789abcdef"[(key >> (4 * k)) & 15];
  return out;
}

/// Letters, digits, - and _ alone.
std::string plain(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '_';
  return text;
}

Archive archive_of_body(const Body& body) {
  const MeshSequence& sequence = body.normalized.sequence;
  Archive archive;
  Eigen::MatrixXd frames(3 * sequence.vertex_count(), sequence.frame_count());
  for (int k = 0; k < sequence.frame_count(); ++k) frames.col(k) = sequence.frames[std::size_t(k)].reshaped();
  archive.set("body.frames", std::move(frames));
  archive.set("body.faces", Archive::Integers(sequence.faces.cast<std::int64_t>()));
  archive.set("body.cap_faces", sequence.cap_faces);
  archive.set("body.duration", sequence.duration);
  archive.set("body.name", sequence.name);
  archive.set("body.file", body.file.string());
  archive.set("body.trajectory", Eigen::MatrixXd(body.normalized.trajectory));
  archive.set("body.scale", body.normalized.scale);
  archive.set("body.sphere", Eigen::MatrixXd(body.sphere.vertices));
  return archive;
}

Body body_of_archive(const Archive& archive) {
  const auto& frames = archive.get<Eigen::MatrixXd>("body.frames");
  const Index n = frames.rows() / 3;
  MeshSequence sequence;
  for (Index k = 0; k < frames.cols(); ++k) sequence.frames.push_back(frames.col(k).reshaped(3, n));
  const auto& faces = archive.get<Archive::Integers>("body.faces");
  require<FileError>(faces.rows() == 3 && faces.size() > 0 && faces.minCoeff() >= 0 && faces.maxCoeff() < n,
                     archive.name(), ": faces name vertices that do not exist");
  sequence.faces = faces.cast<int>();
  sequence.cap_faces = archive.integer("body.cap_faces", 0, faces.cols());
  sequence.duration = archive.number("body.duration");
  sequence.name = archive.text("body.name");
  const TriangleMesh sphere{archive.get<Eigen::MatrixXd>("body.sphere", 3, n), sequence.faces};
  AnyAnimatedSurface surface = archive.contains("surface")
                                   ? surface_from(archive)
                                   : AnyAnimatedSurface(SampledSurface(sequence, sphere.vertices));
  const Mat3X trajectory = archive.get<Eigen::MatrixXd>("body.trajectory", 3, frames.cols());
  return {{std::move(sequence), trajectory, archive.number("body.scale")},
          sphere,
          {},
          std::move(surface),
          archive.text("body.file"),
          {},
          {}};
}

/// A body made or found, or why there is none.
struct Prepared {
  std::optional<Group::Member> member;
  std::optional<Body> body;  ///< where it is held in memory
  std::vector<std::string> done;
  std::optional<FitFigures> fit;
  std::string failure;
};

Group::Member member_of(const Body& body, std::string source, std::size_t place) {
  return {std::move(source),
          body.file.stem().string() + " " + body.normalized.sequence.name,
          body.file,
          body.normalized.trajectory,
          body.normalized.scale,
          body.normalized.sequence.duration,
          place,
          0,
          {}};
}

/// From its file in the work folder, or from the source, of which the file is then made.
Prepared prepare(const std::string& source, std::size_t place, const fs::path& kept, const Settings& settings) {
  Prepared out;
  try {
    if (!kept.empty() && fs::exists(kept)) {
      out.done = {"found in " + kept.string()};
      out.member = member_of(body_of_archive(read_archive(kept)), source, place);
      return out;
    }
    LoadedBody loaded = read_body(source, settings, {});
    out.done = std::move(loaded.done);
    Archive archive = archive_of_body(loaded.body);
    if (settings.representation == Representation::neural) {
      const Fitted fitted = fit_body(loaded.body, settings, {});
      out.fit = fitted.figures;
      std::visit([&](const auto& surface) { store_surface(archive, surface); }, fitted.surface);
    }
    out.member = member_of(loaded.body, source, place);
    if (kept.empty())
      out.body = std::move(loaded.body);
    else
      write_archive(kept, archive);
  } catch (const Error& error) {
    out.failure = error.what();
  }
  return out;
}

}  // namespace

Group::Group(std::vector<Body> bodies) : bodies_(std::move(bodies)), given_(bodies_.size()) {
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    members_.push_back(member_of(bodies_[i], bodies_[i].file.string(), i));
}

Group::Group(const std::vector<std::string>& sources, const Settings& settings, Report& report, std::size_t least)
    : folder_(settings.work), given_(sources.size()) {
  if (!folder_.empty()) {
    std::error_code failure;
    fs::create_directories(folder_, failure);
    require<FileError>(!failure, "folder '", folder_.string(), "' cannot be created: ", failure.message());
  }
  std::vector<Prepared> prepared(sources.size());
  std::mutex reporting;
  std::size_t ready = 0;
  ProgressLine line;
  parallel_for(static_cast<int>(sources.size()), settings.threads, [&](int k) {
    const auto i = std::size_t(k);
    const std::uint64_t key = folder_.empty() ? 0 : key_of_source(sources[i], settings);
    const SourceName name = parse_source(sources[i]);
    const fs::path kept = folder_.empty() ? fs::path()
                                          : folder_ / ("body_" + plain(name.file.stem().string() + "_" + name.clip) +
                                                       "_" + hexadecimal(key) + ".dsns");
    Settings alone = settings;
    alone.threads = 1;
    prepared[i] = prepare(sources[i], i, kept, alone);
    if (prepared[i].member) {
      prepared[i].member->key = key;
      prepared[i].member->kept = kept;
    }
    const std::lock_guard lock(reporting);
    line("animations", double(++ready) / double(sources.size()));
  });
  std::vector<std::string> unusable;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    Prepared& p = prepared[i];
    if (!p.member) {
      require<FileError>(sources.size() > 2, p.failure);
      std::cerr << "dsns: " << p.failure << '\n';
      unusable.push_back(sources[i]);
      continue;
    }
    report.say(sources[i] + ":");
    for (const auto& sentence : p.done) report.say("  " + sentence);
    if (p.fit) {
      report.section(message("fit.", members_.size() + 1));
      report_fit(*p.fit, report);
      report.section("");
    }
    members_.push_back(std::move(*p.member));
    if (p.body) bodies_.push_back(std::move(*p.body));
  }
  if (unusable.empty()) return;
  report.note("left_out", unusable);
  require<FileError>(settings.keep_going, unusable.size(), " of ", sources.size(),
                     " animations cannot be used, see above: mend them, or leave them out with --keep-going");
  require<FileError>(members_.size() >= least, "only ", members_.size(), " of ", sources.size(),
                     " animations can be used, ", least, " are needed");
  report.figure("used", "animations that can be used", members_.size());
}

Body Group::body(std::size_t i) const {
  return bodies_.empty() ? body_of_archive(read_archive(members_[i].kept)) : bodies_[i];
}

AnyAnimatedSurface Group::surface(std::size_t i) const {
  return bodies_.empty() ? body(i).surface : bodies_[i].surface;
}

ResultStore Group::store(std::size_t chosen, const std::string& what) const {
  if (folder_.empty()) return {};
  std::vector<std::uint64_t> keys;
  for (const Member& member : members_) keys.push_back(member.key);
  std::sort(keys.begin(), keys.end());
  std::string all = what;
  for (const std::uint64_t key : keys) all += hexadecimal(key);
  const std::string group = hexadecimal(xxh64(all, members_[chosen].key));
  const auto path = [this, chosen, what, group](const std::string& name) -> fs::path {
    // registration.I, iteration.K.I or iteration.K with I a member's number in this run
    const std::size_t last = name.rfind('.');
    const bool of_member = name.rfind("registration.", 0) == 0 || std::count(name.begin(), name.end(), '.') == 2;
    if (!of_member) return folder_ / (plain(name) + "_" + group + ".dsns");
    const Member& member = members_[std::stoul(name.substr(last + 1))];
    const std::string key = name.rfind("registration.", 0) == 0
                                ? hexadecimal(xxh64(what + hexadecimal(member.key), members_[chosen].key))
                                : hexadecimal(member.key) + "_" + group;
    return folder_ / (plain(name.substr(0, last)) + "_" + plain(member.name) + "_" + key + ".dsns");
  };
  return {[path](const std::string& name) -> std::optional<Archive> {
            const fs::path file = path(name);
            return fs::exists(file) ? std::optional(read_archive(file)) : std::nullopt;
          },
          [path](const std::string& name, const Archive& archive) { write_archive(path(name), archive); }};
}

}  // namespace dsns::program
