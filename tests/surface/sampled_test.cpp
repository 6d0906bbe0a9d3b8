#include <dsns/surface/sampled.hpp>

#include <cmath>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace sampled_test {

using namespace dsns;

namespace {

/// A noisy sphere map with a body that bends and breathes over it.
struct Fixture {
  TriangleMesh sphere = test::noisy(icosphere(2), 0.03, 4);
  MeshSequence sequence;

  explicit Fixture(int frames = 7) {
    sphere.vertices.colwise().normalize();
    const auto body = [](const Vec3d& s, double t) {
      return Vec3d(2 * s.x() + std::sin(3 * t) * s.z() * s.z(), s.y() * (1 + t),
                   3 * s.z() + 0.2 * std::cos(4 * t) + 10);
    };
    sequence = sequence_of(body, sphere, frames);
  }
};

/// The point of a chart at (u, v).
Vec3d exponential(const ChartBatch& c, Index i, double u, double v) {
  const Vec3d tangent = u * c.e1.col(i) + v * c.e2.col(i);
  const double angle = tangent.norm();
  return angle == 0 ? Vec3d(c.s.col(i)) : Vec3d(std::cos(angle) * c.s.col(i) + std::sin(angle) / angle * tangent);
}

}  // namespace

TEST_CASE("a sampled surface passes through its frames at its vertices", "[sampled]") {
  const int frames = GENERATE(2, 3, 4, 7);
  const Fixture body(frames);
  const SampledSurface surface(body.sequence, body.sphere.vertices);
  for (int k = 0; k < frames; ++k) {
    const double t = double(k) / (frames - 1);
    CHECK((surface.positions(body.sphere.vertices, t) - body.sequence.frames[std::size_t(k)]).cwiseAbs().maxCoeff() <
          1e-12);
    CHECK((surface(Vec3d(body.sphere.vertices.col(17)), t) - body.sequence.frames[std::size_t(k)].col(17)).norm() <
          1e-12);
  }
}

TEST_CASE("between the vertices a sampled surface lies on the mesh's triangles", "[sampled]") {
  const Fixture body;
  const SampledSurface surface(body.sequence, body.sphere.vertices);
  const Mat3X s = test::random_unit_vectors(100, 8);
  const auto hits = surface.locate(s);
  const Mat3X x = surface.positions(s, 0.5);  // the middle of 7 frames
  for (Index i = 0; i < s.cols(); ++i) {
    const auto& hit = hits[std::size_t(i)];
    Mat3 flat, ray;
    for (int k = 0; k < 3; ++k) {
      flat.col(k) = body.sequence.frames[3].col(body.sphere.faces(k, hit.face));
      ray.col(k) = body.sphere.vertices.col(body.sphere.faces(k, hit.face));
    }
    const Vec3d b = ray.inverse() * s.col(i);
    CHECK((flat * b / b.sum() - x.col(i)).norm() < 1e-12);
    CHECK((surface(Vec3d(s.col(i)), 0.5) - x.col(i)).norm() < 1e-13);
  }
  CHECK(surface.positions(hits, 0.5) == x);
}

TEST_CASE("a field that is linear on the polyhedron of the sphere map is reproduced exactly", "[sampled]") {
  const Fixture body;
  MeshSequence sequence = body.sequence;
  Mat3 A;
  A << 1, 2, 3, -1, 4, 0.5, 2, -2, 1;
  const Vec3d b(5, -3, 2);
  for (std::size_t k = 0; k < sequence.frames.size(); ++k) {  // A p (1 + t^3) + t b: cubic in time
    const double t = double(k) / 6;
    sequence.frames[k] = ((1 + t * t * t) * A * body.sphere.vertices).colwise() + t * b;
  }
  const SampledSurface surface(sequence, body.sphere.vertices);
  const Mat3X s = test::random_unit_vectors(60, 2);
  const SphereLocation location(body.sphere.vertices, body.sphere.faces);
  for (const double t : {0.0, 0.21, 0.7, 1.0}) {
    const Mat3X x = surface.positions(s, t), v = surface.velocities(s, t);
    for (Index i = 0; i < s.cols(); ++i) {
      // the ray through s meets the polyhedron at p = s (n . p0) / (n . s)
      const Index f = location(Vec3d(s.col(i))).face;
      const Vec3d p0 = body.sphere.vertices.col(body.sphere.faces(0, f));
      const Vec3d n = (body.sphere.vertices.col(body.sphere.faces(1, f)) - p0)
                          .cross(body.sphere.vertices.col(body.sphere.faces(2, f)) - p0);
      const Vec3d p = s.col(i) * n.dot(p0) / n.dot(s.col(i));
      CHECK((x.col(i) - ((1 + t * t * t) * A * p + t * b)).norm() < 1e-12);
      CHECK((v.col(i) - (3 * t * t * A * p + b)).norm() < 1e-11);
    }
  }
}

TEST_CASE("velocities are the time derivative of positions", "[sampled]") {
  const Fixture body;
  const SampledSurface surface(body.sequence, body.sphere.vertices);
  const Mat3X s = test::random_unit_vectors(20, 6);
  const double h = 1e-5;
  for (const double t : {0.1, 0.5, 0.83}) {
    const Mat3X difference = (surface.positions(s, t + h) - surface.positions(s, t - h)) / (2 * h);
    CHECK((surface.velocities(s, t) - difference).cwiseAbs().maxCoeff() < 1e-7);
    CHECK(surface.velocities(surface.locate(s), t) == surface.velocities(s, t));
  }
}

TEST_CASE("the jets of a sampled surface are its derivatives inside a triangle", "[sampled]") {
  const Fixture body;
  const SampledSurface surface(body.sequence, body.sphere.vertices);
  const double t = 0.37, h = 1e-4;
  Mat3X s(3, 0);
  for (const auto& hit : surface.locate(test::random_unit_vectors(60, 12))) {  // pulled away from the edges
    Vec3d p = Vec3d::Zero();
    for (int k = 0; k < 3; ++k)
      p += (0.5 * hit.barycentric[k] + 0.5 / 3) * body.sphere.vertices.col(body.sphere.faces(k, hit.face));
    s.conservativeResize(3, s.cols() + 1);
    s.rightCols<1>() = p.normalized();
  }
  const ChartBatch charts = charts_at(s);
  const SurfaceJets found = surface.jets(charts, t);
  for (Index i = 0; i < s.cols(); ++i) {
    const auto at = [&](double u, double v) { return surface(exponential(charts, i, u, v), t); };
    CHECK((found.f.col(i) - at(0, 0)).norm() < 1e-13);
    CHECK((found.fu.col(i) - (at(h, 0) - at(-h, 0)) / (2 * h)).norm() < 1e-7);
    CHECK((found.fv.col(i) - (at(0, h) - at(0, -h)) / (2 * h)).norm() < 1e-7);
    CHECK((found.fuu.col(i) - (at(h, 0) - 2 * at(0, 0) + at(-h, 0)) / (h * h)).norm() < 1e-5);
    CHECK((found.fvv.col(i) - (at(0, h) - 2 * at(0, 0) + at(0, -h)) / (h * h)).norm() < 1e-5);
    CHECK((found.fuv.col(i) - (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h)).norm() < 1e-5);
  }
}

TEST_CASE("a sampled surface through frames at uneven times passes through them, and is exact for cubics",
          "[sampled]") {
  const Fixture body;
  const std::vector<double> times{0, 0.1, 0.15, 0.5, 0.8, 0.9, 1};
  MeshSequence sequence = body.sequence;
  for (std::size_t k = 0; k < times.size(); ++k)
    sequence.frames[k] = (1 + std::pow(times[k], 3)) * body.sphere.vertices;
  const SampledSurface surface(sequence, body.sphere.vertices, times);
  for (const double t : {0.0, 0.1, 0.3, 0.77, 1.0})
    CHECK((surface.positions(body.sphere.vertices, t) - (1 + t * t * t) * body.sphere.vertices).cwiseAbs().maxCoeff() <
          1e-12);
  CHECK_THROWS_AS(SampledSurface(sequence, body.sphere.vertices, {0, 1}), InvalidArgument);
}

TEST_CASE("interpolated normals of a round sphere point outwards, exactly at symmetric vertices", "[sampled]") {
  const TriangleMesh ball = icosphere(3);
  const SampledSurface surface(sequence_of([](const Vec3d& s, double t) { return Vec3d((2 + t) * s); }, ball, 4),
                               ball.vertices);
  CHECK((surface.normals(Mat3X(ball.vertices.leftCols(12)), 0.4) - ball.vertices.leftCols(12)).cwiseAbs().maxCoeff() <
        1e-12);  // those of the icosahedron
  const Mat3X s = test::random_unit_vectors(200, 3), n = surface.normals(s, 0.4);
  CHECK((n.colwise().norm().array() - 1).abs().maxCoeff() < 1e-12);
  // Flat faces' normals are off by up to the angle from a face's middle to its corner, 0.08.
  CHECK((n - s).colwise().norm().maxCoeff() < 0.02);
}

TEST_CASE("interpolated normals blend the corners' and leave out faces that close holes", "[sampled]") {
  Fixture body;
  body.sequence.cap_faces = 40;
  const SampledSurface surface(body.sequence, body.sphere.vertices);
  const Mat3X s = test::random_unit_vectors(200, 5), found = surface.normals(s, 0.5);
  const auto hits = surface.locate(s);
  Index caps = 0;
  for (Index i = 0; i < s.cols(); ++i) {
    const SphereHit& hit = hits[std::size_t(i)];
    caps += surface.on_cap(hit);
    CHECK(surface.on_cap(hit) == (hit.face >= body.sequence.faces.cols() - 40));
    Vec3d blended = Vec3d::Zero();
    for (int k = 0; k < 3; ++k) {
      Vec3d sum = Vec3d::Zero();
      for (Index f = 0; f < body.sequence.faces.cols() - 40; ++f) {
        const Eigen::Vector3i face = body.sequence.faces.col(f).cast<int>();
        if ((face.array() != int(body.sequence.faces(k, hit.face))).all()) continue;
        const Mat3X& x = body.sequence.frames[3];
        sum += (x.col(face[1]) - x.col(face[0])).cross(x.col(face[2]) - x.col(face[0]));
      }
      blended += hit.barycentric[k] * sum.stableNormalized();
    }
    CHECK((blended.stableNormalized() - found.col(i)).norm() < 1e-11);
  }
  CHECK(caps > 0);
}

TEST_CASE("a sampled surface meets the customisation points", "[sampled]") {
  const Fixture body;
  const SampledSurface surface(body.sequence, body.sphere.vertices);
  const Mat3X s = test::random_unit_vectors(5, 1);
  const auto frozen = at_time(surface, 0.4);
  CHECK(positions(frozen, s) == surface.positions(s, 0.4));
  CHECK(velocities(surface, s, 0.4) == surface.velocities(s, 0.4));
  CHECK(jets(frozen, charts_at(s)).fuv == surface.jets(charts_at(s), 0.4).fuv);
}

TEST_CASE("a sampled surface refuses frames that do not fit the sphere map", "[sampled]") {
  Fixture body;
  CHECK_THROWS_AS(SampledSurface(body.sequence, icosphere(1).vertices), InvalidArgument);
  body.sequence.frames.back() = icosphere(1).vertices;
  CHECK_THROWS_AS(SampledSurface(body.sequence, body.sphere.vertices), InvalidArgument);
  body.sequence.frames.clear();
  CHECK_THROWS_AS(SampledSurface(body.sequence, body.sphere.vertices), InvalidArgument);
}

}  // namespace sampled_test
