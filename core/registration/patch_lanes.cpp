// Loops in a file of their own for its compiler options: no products joined with sums, so that every
// instruction set gives the same bits, and no care for numbers that are not finite.
#include "core/registration/patch_lanes.h"

#include <cmath>

#include "core/base/clones.h"
#include "core/registration/plane_patch.h"

namespace tiltmap {

namespace {

// Truth values are numbers here: the compiler does not put mixed widths side by side.
constexpr double truth(bool is) {
  return is ? 1.0 : 0.0;
}
constexpr double smaller(double a, double b) {
  return a < b ? a : b;
}
constexpr double larger(double a, double b) {
  return a > b ? a : b;
}

// x^3 - trace x^2 + minors x - determinant is zero at the eigenvalues; convex and falling left of the least.
struct Cubic {
  double trace, minors, determinant;

  // One of Newton's steps from below. A plane's smaller eigenvalues differ ninefold, so that the bound that
  // they begin from is within a ninth of the root, and each step squares what is left.
  double nearer(double x) const {
    const double slope = minors - x * (2.0 * trace - 3.0 * x);
    const double value = determinant - x * (minors - x * (trace - x));
    const double on = value / (slope > 0.0 ? slope : 1.0);
    return x + (slope > 0.0 ? larger(on, 0.0) : 0.0);
  }
};

}  // namespace

TILTMAP_CLONES
void spreadGroups(std::size_t count, GroupLanes& groups) {
  GroupLanes& g = groups;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = 1.0 / g.n[i];
    const double x = share * g.x[i], y = share * g.y[i], z = share * g.z[i];
    const double xx = share * g.xx[i] - x * x, xy = share * g.xy[i] - x * y, xz = share * g.xz[i] - x * z;
    const double yy = share * g.yy[i] - y * y, yz = share * g.yz[i] - y * z, zz = share * g.zz[i] - z * z;
    const double of_xx = yy * zz - yz * yz, of_yy = xx * zz - xz * xz, of_zz = xx * yy - xy * xy;
    const double minors = of_xx + of_yy + of_zz;
    const double determinant = xx * of_xx - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    const double least = determinant / (minors > 0.0 ? minors : 1.0);
    g.x[i] = x, g.y[i] = y, g.z[i] = z;
    g.xx[i] = xx, g.xy[i] = xy, g.xz[i] = xz, g.yy[i] = yy, g.yz[i] = yz, g.zz[i] = zz;
    g.trace[i] = xx + yy + zz;
    g.least[i] = minors > 0.0 ? larger(least, 0.0) : 0.0;
  }
}

static_assert(static_cast<int>(GroupFate::Dropped) == 0 && static_cast<int>(GroupFate::Kept) == 1);

TILTMAP_CLONES
void judgePlanes(std::size_t count, const GroupLanes& __restrict groups, const PlaneRule& rule,
                 PlaneLanes& __restrict planes) {
  const GroupLanes& __restrict g = groups;
  const PlaneRule r = rule;
  const double split = r.can_split ? 1.0 : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double xx = g.xx[i], xy = g.xy[i], xz = g.xz[i], yy = g.yy[i], yz = g.yz[i], zz = g.zz[i];
    const double trace = g.trace[i];
    const double of_xx = yy * zz - yz * yz, of_yy = xx * zz - xz * xz, of_zz = xx * yy - xy * xy;
    const double minors = of_xx + of_yy + of_zz;
    const double determinant = xx * of_xx - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    const Cubic cubic{trace, minors, determinant};
    const double least = cubic.nearer(cubic.nearer(cubic.nearer(cubic.nearer(g.least[i]))));
    // At right angles to the rows of covariance - least: the longest of their products.
    const double ax = xx - least, by = yy - least, cz = zz - least;
    const double abx = xy * yz - xz * by, aby = xz * xy - ax * yz, abz = ax * by - xy * xy;
    const double bcx = by * cz - yz * yz, bcy = yz * xz - xy * cz, bcz = xy * yz - by * xz;
    const double cax = yz * xz - cz * xy, cay = cz * ax - xz * xz, caz = xz * xy - yz * ax;
    const double ab = abx * abx + aby * aby + abz * abz, bc = bcx * bcx + bcy * bcy + bcz * bcz;
    const double ca = cax * cax + cay * cay + caz * caz;
    const double most = larger(ab, larger(bc, ca));
    const double scale = ax * ax + by * by + cz * cz + 2.0 * (xy * xy + xz * xz + yz * yz);
    const bool is_plane = most > 1e-24 * scale * scale;
    const double length = 1.0 / std::sqrt(is_plane ? most : 1.0);
    const bool take_ab = ab >= larger(bc, ca), take_bc = bc >= ca;
    double nx = length * (take_ab ? abx : take_bc ? bcx : cax);
    double ny = length * (take_ab ? aby : take_bc ? bcy : cay);
    double nz = length * (take_ab ? abz : take_bc ? bcz : caz);
    // Two axes across it, of the same length; then the covariance along them.
    const double mx = std::abs(nx), my = std::abs(ny), mz = std::abs(nz);
    const bool first_x = mx <= smaller(my, mz), first_y = my <= mz;
    const double fx = first_x ? 0.0 : first_y ? -nz : ny;
    const double fy = first_x ? nz : first_y ? 0.0 : -nx;
    const double fz = first_x ? -ny : first_y ? nx : 0.0;
    const double sx = ny * fz - nz * fy, sy = nz * fx - nx * fz, sz = nx * fy - ny * fx;
    const double square = fx * fx + fy * fy + fz * fz;
    const double share = 1.0 / (is_plane ? square : 1.0);
    const double tx = xx * fx + xy * fy + xz * fz, ty = xy * fx + yy * fy + yz * fz;
    const double tz = xz * fx + yz * fy + zz * fz;
    const double wx = xx * sx + xy * sy + xz * sz, wy = xy * sx + yy * sy + yz * sz;
    const double wz = xz * sx + yz * sy + zz * sz;
    const double a = share * (fx * tx + fy * ty + fz * tz), b = share * (sx * tx + sy * ty + sz * tz);
    const double c = share * (sx * wx + sy * wy + sz * wz);
    const double half = 0.5 * (a - c), middle = 0.5 * (a + c);
    const double spread = std::sqrt(half * half + b * b);
    const double second = larger(middle - spread, least), third = larger(middle + spread, least);
    const bool has_axis = spread > 0.0;
    const double p = has_axis ? (half > 0.0 ? half + spread : b) : 1.0;
    const double q = has_axis ? (half > 0.0 ? b : spread - half) : 0.0;
    const double along = 1.0 / std::sqrt(is_plane ? (p * p + q * q) * square : 1.0);
    const double ux = along * (p * fx + q * sx), uy = along * (p * fy + q * sy);
    const double uz = along * (p * fz + q * sz);

    const double x = g.x[i], y = g.y[i], z = g.z[i], n = g.n[i];
    const double range_square = x * x + y * y + z * z;
    const double range = std::sqrt(range_square);
    const double towards = nx * x + ny * y + nz * z;
    const double cosine = smaller(std::abs(towards) / larger(range, 1e-9), 1.0);
    const double cos_square = cosine * cosine;
    const double planar = truth(least < 2.0 * (r.noise_square * cos_square + r.floor_square));
    const double rough = truth(least < 2.0 * (r.rough_noise_square * cos_square + r.rough_floor_square));
    const double spot = r.spot_rad * std::sqrt(1.0 - cos_square) / larger(cosine, 1e-6);
    const double back = 1.0 + spot * spot;
    const double told = truth(4.0 * spot * range <= kLongestSpot_m);
    const double freedom = larger(n - kPlaneFreedom, 1.0);
    const double residual =
        (least * n + r.prior_points * r.prior_noise_square * cos_square) / (freedom + r.prior_points) +
        kResidualFloor_m * kResidualFloor_m;
    const double stands_out =
        truth(most > 1e-24 * scale * scale) * truth(second >= 9.0 * least) * truth(second > 0.0);
    const double divide = split * larger(truth(third > r.largest_square), 1.0 - planar);
    const double keep = larger(planar, rough) * told * stands_out;
    planes.fate[i] = divide > 0.0 ? static_cast<double>(GroupFate::Split) : keep;

    planes.x[i] = back * x, planes.y[i] = back * y, planes.z[i] = back * z;
    const double side = towards > 0.0 ? -1.0 : 1.0;
    planes.vx[i] = uy * nz - uz * ny, planes.vy[i] = uz * nx - ux * nz, planes.vz[i] = ux * ny - uy * nx;
    nx *= side, ny *= side, nz *= side;
    planes.nx[i] = nx, planes.ny[i] = ny, planes.nz[i] = nz;
    planes.ux[i] = ux, planes.uy[i] = uy, planes.uz[i] = uz;
    planes.offset_variance[i] = residual / n + kOffsetFloor_m * kOffsetFloor_m;
    planes.tilt_u[i] = residual / (n * larger(third, 1e-12));
    planes.tilt_v[i] = residual / (n * larger(second, 1e-12));
    planes.extent_u[i] = std::sqrt(third), planes.extent_v[i] = std::sqrt(second);
    planes.residual[i] = std::sqrt(least);
  }
}

}  // namespace tiltmap
