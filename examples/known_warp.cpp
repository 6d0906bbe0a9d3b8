// Registration against the truth: a body is turned, its sphere warped by about 5 degrees and its clock bent; registration,
// which is told none of this, must find the three again.  known_warp [FILE.glb#Clip]; without a file, a body from a formula.
#include <dsns/elastic/normalization.hpp>
#include <dsns/io/gltf_reader.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/mesh/repair.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/stats/co_registration.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/sampled.hpp>

#include <iostream>

using namespace dsns;

namespace {

MeshSequence made_body() {
  LimbedBody body;
  body.axes = {1, 0.6, 0.5};
  body.limbs = {{Vec3d(0.8, -0.8, 0.5).normalized(), 12, Vec3d(0, -0.8, 0.1), Vec3d(0.3, 0, 0)},
                {Vec3d(0.8, -0.8, -0.5).normalized(), 12, Vec3d(0, -0.8, -0.1), Vec3d(0.3, 0, 0), 0.5},
                {Vec3d(-0.8, -0.8, 0).normalized(), 8, Vec3d(0, -0.7, 0), Vec3d(-0.2, 0, 0.1), 0.2},
                {Vec3d(1, 0.4, 0).normalized(), 10, Vec3d(0.5, 0.6, 0), Vec3d(0, 0.1, 0.2), 0.1}};
  return sequence_of(body, icosphere(3), 24);
}

MeshSequence read_body(const char* name) {
  const SourceName source = parse_source(name);
  return repair(read_gltf(source.file, {source.clip, 32}).sequence).sequence;
}

}  // namespace

int main(int argc, char** argv) try {
  const NormalizedSequence body = normalize(argc > 1 ? read_body(argv[1]) : made_body());
  const TriangleMesh sphere{spherical_parameterization(body.sequence).sphere, body.sequence.faces};
  const SampledSurface second(body.sequence, sphere.vertices);

  constexpr double degree = pi / 180;
  const SphereDiffeomorphism warp = random_diffeomorphism(7, 3, 5 * degree);
  SphereDiffeomorphism gamma(rotation_exp(Vec3d(0.4, 2.0, -0.3)));
  for (const auto& field : warp.increments()) gamma.append(field);
  const Mat3 O = rotation_exp(Vec3d(-0.9, 0.5, 1.4));
  const TimeWarp zeta = random_warp(3, 0.4);
  const RegisteredSurface first(second, O, gamma, zeta);

  RegistrationOptions options;  // RotationSearch::full: any turn of body and sphere
  options.spatial.threads = 2;
  const MovingRegistration r = register_moving(first, second, sphere, options);

  const auto rms_deg = [&](const Mat3X& a, const Mat3X& b) {
    double sum = 0;
    for (Index i = 0; i < a.cols(); ++i) sum += std::pow(angle_between(a.col(i), b.col(i)), 2) / double(a.cols());
    return std::sqrt(sum) / degree;
  };
  const Mat3X s = fibonacci_sphere(2000).points;
  const double miss = rms_deg(r.spatial.gamma(s), gamma(s)), miss_time = distance(r.temporal.warp, zeta);
  std::cout << "sphere: warped by " << rms_deg(warp(s), s) << " degrees rms after a turn of "
            << rotation_angle(gamma.rotation()) / degree << ", recovered to " << miss << " degrees rms\n"
            << "body:   turned by " << rotation_angle(O) / degree << " degrees, recovered to "
            << rotation_angle(r.spatial.rotation * O.transpose()) / degree << '\n'
            << "time:   bent by " << distance(zeta, {}) << " (L2), recovered to " << miss_time << '\n'
            << "energy in space " << r.spatial.summary.energy_before << " -> " << r.spatial.summary.energy_after
            << ", in time " << r.temporal.summary.energy_before << " -> " << r.temporal.summary.energy_after << '\n';
  return miss < 1 && miss_time < 1e-2 ? 0 : 1;
} catch (const Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
