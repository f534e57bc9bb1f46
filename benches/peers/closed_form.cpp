// The decoder in plain C++, without a library, written to be hard to beat: constants multiplied out once, nothing allocated, no
// branch in a sample, nothing iterated, no square root and no division; sums in an order in which each product has an addition to
// fuse with, which without -ffast-math no compiler may find by itself.
//
// The unit of length is the limb length L and that of time the sample interval, so most factors of the equations become one. In (2)
// a limb's force is proportional to its strain x, f/m = chi x, so nine strains are all there is to know of a sample. They are
// 1e-5 at the rig's 9 g: everything is expanded in them and kept to the third power, what is dropped is below rounding.

#include <cmath>

#include "protocol.hpp"

namespace {

using peers::kLimbs;
using peers::PerLimb;
using peers::Problem;
using peers::Row;

struct Vec {
    double x, y, z;
};

inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double sum(Vec a) { return a.x + a.y + a.z; }
inline Vec cross(Vec a, Vec b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// c + a x b.
inline Vec cross_plus(Vec a, Vec b, Vec c) {
    return {c.x + a.y * b.z - a.z * b.y, c.y + a.z * b.x - a.x * b.z, c.z + a.x * b.y - a.y * b.x};
}
// c + s a.
inline Vec plus(Vec c, double s, Vec a) { return {c.x + s * a.x, c.y + s * a.y, c.z + s * a.z}; }

struct Mat {
    Vec row[3];
};

inline Vec operator*(const Mat& m, Vec v) { return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)}; }

struct Quaternion {
    double w;
    Vec v;
};

// Eigenvalues of a symmetric matrix and a right-handed basis of eigenvectors, as rows: Jacobi's rotations.
Vec principal(Mat m, Mat& axes) {
    double a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; ++i) {
        a[i][0] = m.row[i].x, a[i][1] = m.row[i].y, a[i][2] = m.row[i].z;
    }
    for (int sweep = 0; sweep < 20; ++sweep) {
        for (int p = 0; p < 2; ++p) {
            for (int q = p + 1; q < 3; ++q) {
                const double angle = 0.5 * std::atan2(2.0 * a[p][q], a[q][q] - a[p][p]);
                const double c = std::cos(angle), s = std::sin(angle);
                for (int k = 0; k < 3; ++k) {
                    const double kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - s * kq, a[k][q] = s * kp + c * kq;
                }
                for (int k = 0; k < 3; ++k) {
                    const double pk = a[p][k], qk = a[q][k];
                    a[p][k] = c * pk - s * qk, a[q][k] = s * pk + c * qk;
                    const double vp = v[p][k], vq = v[q][k];
                    v[p][k] = c * vp - s * vq, v[q][k] = s * vp + c * vq;
                }
            }
        }
    }
    for (int i = 0; i < 3; ++i) axes.row[i] = {v[i][0], v[i][1], v[i][2]};
    if (dot(cross(axes.row[0], axes.row[1]), axes.row[2]) < 0.0) axes.row[2] = -1.0 * axes.row[2];
    return {a[0][0], a[1][1], a[2][2]};
}

// Pose of the mass in the shell.
struct Pose {
    Vec r3;    // three times its position
    Vec half;  // half its rotation vector
};

// What the voltages say of one sample.
struct Placed {
    Pose pose;
    Vec force;   // sum of the limb forces over chi, shell axes
    Vec torque;  // of the limb forces, over the principal moments, principal axes
};

// w*, w*' and R^T (a - g).
struct Shell {
    Vec w, w_dot, force;
};

class Decoder {
public:
    explicit Decoder(const Problem& p) {
        const double h = 1.0 / p.sample_rate_hz, length = p.limb_length_m;
        const double nu = p.half_edge_m / length;
        // The sign of (2): a limb that pushes is shorter.
        const double strain_per_force = -1.0 / (p.stiffness_per_mass_per_s2 * length);
        for (int i = 0; i < kLimbs; ++i) {
            const double force_per_v = p.scale_per_mass_per_kg[i] * p.gain_n_per_v[i];
            slope_[i] = force_per_v * strain_per_force;
            zero_[i] = (p.preload_per_mass_m_s2[i] - force_per_v * p.zero_drift_v[i]) * strain_per_force;
        }
        const double chi = h * h / (length * strain_per_force);
        chi_ = chi, nu_ = nu, inverse_nu_ = 1.0 / nu;
        Mat inertia, axes;
        for (int i = 0; i < 3; ++i) {
            const auto& row = p.inertia_per_mass_m2[i];
            inertia.row[i] = (1.0 / (length * length)) * Vec{row[0], row[1], row[2]};
        }
        const Vec moment = principal(inertia, axes);
        const double moments[3] = {moment.x, moment.y, moment.z};
        for (int i = 0; i < 3; ++i) torque_.row[i] = (chi * nu / moments[i]) * axes.row[i];
        const Vec *a = &axes.row[0], *b = &axes.row[1], *c = &axes.row[2];
        to_mass_ = {{{a->x, b->x, c->x}, {a->y, b->y, c->y}, {a->z, b->z, c->z}}};
        gyro_ = {(moment.y - moment.z) / moment.x, (moment.z - moment.x) / moment.y,
                 (moment.x - moment.y) / moment.z};
        gravity_ = {p.gravity_ground_m_s2[0], p.gravity_ground_m_s2[1], p.gravity_ground_m_s2[2]};
        per_s2_ = 1.0 / (h * h), m_per_s2_ = length / (h * h);
        const auto& r = p.initial_attitude;
        q_.w = 0.5 * std::sqrt(1.0 + r[0][0] + r[1][1] + r[2][2]);
        q_.v = (0.25 / q_.w) * Vec{r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
    }

    // The first three samples, at the middle one of which the shell does not turn.
    Row begin(const PerLimb* volts) {
        before_ = place(volts[0]).pose;
        now_ = place(volts[1]);
        const Placed after = place(volts[2]);
        // W = R_r^T w_r in principal axes.
        const Vec back = -1.0 * now_.pose.half, w_r = relative_rate(after);
        const Vec mass = plus(w_r, 2.0, cross(back, cross_plus(back, w_r, w_r)));
        const Vec* m = to_mass_.row;
        spin_ = mass.x * m[0] + mass.y * m[1] + mass.z * m[2];
        spin_dot_ = euler(spin_, now_.torque);
        shell_ = motion(after);
        return advance(after);
    }

    // The next nine voltages; the row of the sample before them.
    [[gnu::always_inline]] inline Row push(const PerLimb& volts) {
        const Placed after = place(volts);
        // (8) by Heun, for the rate of the mass in principal axes: the relative acceleration drops out of it.
        const Vec end = euler(spin_ + spin_dot_, now_.torque);
        spin_ = plus(spin_, 0.5, spin_dot_ + end);
        spin_dot_ = euler(spin_, now_.torque);
        const Shell next = motion(after);
        turn(next);
        shell_ = next;
        return advance(after);
    }

private:
    // (1), (2), (10), (11), the pose in closed form, and the sums of (3) and (8).
    [[gnu::always_inline]] inline Placed place(const PerLimb& u) const {
        double xi[kLimbs], f[kLimbs];
        for (int node = 0; node < kLimbs; node += 3) {
            double x[3], x2[3];
            for (int i = 0; i < 3; ++i) {
                x[i] = slope_[node + i] * u[node + i] + zero_[node + i];
                x2[i] = x[i] * x[i];
            }
            // The node's displacement along limb i, xi_i = x_i + (x_i^2 - S)/2, S = |displacement|^2 = a - a b + sum x^3 + ...;
            // the limb's force is x_i/(1 + x_i) along e_i + displacement.
            const double a = x2[0] + x2[1] + x2[2], b = x[0] + x[1] + x[2];
            const double s = a - a * b + x[0] * x2[0] + x[1] * x2[1] + x[2] * x2[2];
            const double half_s = 0.5 * s, all = b - a;
            for (int i = 0; i < 3; ++i) {
                const double beyond = 0.5 * x2[i] - half_s;
                xi[node + i] = x[i] + beyond;
                f[node + i] = x[i] + x[i] * beyond + xi[node + i] * (all - x[i] + x2[i]);
            }
        }
        // Directions (5); nodes 1, 2, 3 are on the z, y and x axis.
        const Vec p1{-xi[2], -xi[1], xi[0]}, p2{-xi[5], xi[4], -xi[3]}, p3{xi[8], -xi[7], -xi[6]};
        const Vec f1{-f[2], -f[1], f[0]}, f2{-f[5], f[4], -f[3]}, f3{f[8], -f[7], -f[6]};

        // The rotation that fits the three nodes best: linear in the displacements, then what R_r - 1 has beyond phi x.
        const Vec all = p1 + p2 + p3;
        const double third = 1.0 / 3.0, sixth = 1.0 / 6.0;
        const Vec t_p{p1.y - p2.z, p3.z - p1.x, p2.x - p3.y};
        const double mean = sixth * sum(t_p);
        const Vec l{inverse_nu_ * (t_p.x - mean + third * (all.z - all.y)),
                    inverse_nu_ * (t_p.y - mean + third * (all.x - all.z)),
                    inverse_nu_ * (t_p.z - mean + third * (all.y - all.x))};
        const double s = sum(l), c = sixth * s, c2 = c * c, c3 = c2 * s, k = 1.0 - 3.0 * c2;
        const Vec arc{c3 + k * l.x + c * (l.z - l.y), c3 + k * l.y + c * (l.x - l.z), c3 + k * l.z + c * (l.y - l.x)};
        const Vec phi = plus(arc, sixth * dot(l, l), l);
        const Vec lean{1.0 + 0.5 * (arc.y - arc.z), 1.0 + 0.5 * (arc.z - arc.x), 1.0 + 0.5 * (arc.x - arc.y)};

        // sum t_j x R_r^T F_j over the half edge, to the second power of phi.
        const Vec half = 0.5 * phi;
        const Vec t{f1.y - f2.z, f3.z - f1.x, f2.x - f3.y};
        const Vec y = plus(plus(phi.x * f3, phi.y, f2), phi.z, f1);
        const double along = f3.x + f2.y + f1.z - dot(half, t);
        const Vec torque = cross_plus(half, y, plus(t - y, along, phi));
        return {{plus(all, nu_, cross(arc, lean)), half}, f1 + f2 + f3, torque_ * torque};
    }

    // (8) in principal axes.
    inline Vec euler(Vec w, Vec torque) const {
        return {torque.x + gyro_.x * w.y * w.z, torque.y + gyro_.y * w.z * w.x, torque.z + gyro_.z * w.x * w.y};
    }

    // Principal axes to shell axes; to the second power of phi.
    inline Vec to_shell(Vec principal) const {
        const Vec v = to_mass_ * principal, half = now_.pose.half;
        return plus(v, 2.0, cross(half, cross_plus(half, v, v)));
    }

    inline Vec relative_rate(const Placed& after) const {
        const Vec d = after.pose.half - before_.half;
        return cross_plus(now_.pose.half, d, d);
    }

    // From the mass to the shell, and (3).
    [[gnu::always_inline]] inline Shell motion(const Placed& after) const {
        const Vec r = now_.pose.r3, half = now_.pose.half;
        const Vec w_r = relative_rate(after);
        const Vec d = plus(after.pose.half + before_.half, -2.0, half);
        const Vec half_eps = cross_plus(half, d, d);
        Shell shell;
        shell.w = to_shell(spin_) - w_r;
        shell.w_dot = cross_plus(w_r, shell.w, plus(to_shell(spin_dot_), -2.0, half_eps));
        const Vec relative = plus(after.pose.r3 + before_.r3, -2.0, r);
        const Vec inner = cross_plus(shell.w, r, after.pose.r3 - before_.r3);
        const Vec carried = cross_plus(shell.w_dot, r, cross_plus(shell.w, inner, relative));
        shell.force = plus(chi_ * now_.force, -1.0 / 3.0, carried);
        return shell;
    }

    // (9) to fourth order: Hermite's quadrature of the rate and the coning term.
    inline void turn(const Shell& next) {
        const Vec small = cross_plus(shell_.w, next.w, shell_.w_dot - next.w_dot);
        const Vec half = plus(0.25 * (shell_.w + next.w), 1.0 / 24.0, small);
        const double z = dot(half, half);
        const double unit = 1.5 - 0.5 * (q_.w * q_.w + dot(q_.v, q_.v));
        const double sinc = unit * (1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 - z * (1.0 / 5040.0))));
        const double cosine = unit * (1.0 + z * (-0.5 + z * (1.0 / 24.0 - z * (1.0 / 720.0))));
        const Vec v = sinc * half;
        q_ = {q_.w * cosine - dot(q_.v, v), cross_plus(q_.v, v, plus(cosine * q_.v, q_.w, v))};
    }

    inline Vec rotated(Vec v) const { return cross_plus(q_.v + q_.v, cross_plus(q_.v, v, q_.w * v), v); }

    // On by a sample; the row in ground axes, SI.
    [[gnu::always_inline]] inline Row advance(const Placed& after) {
        before_ = now_.pose;
        now_ = after;
        const Vec a = plus(gravity_, m_per_s2_, rotated(shell_.force));
        const Vec w_dot = per_s2_ * rotated(shell_.w_dot);
        return {a.x, a.y, a.z, w_dot.x, w_dot.y, w_dot.z};
    }

    double slope_[kLimbs], zero_[kLimbs];
    double chi_, nu_, inverse_nu_, per_s2_, m_per_s2_;
    Mat torque_, to_mass_;
    Vec gyro_, gravity_;

    Pose before_;
    Placed now_;
    Vec spin_, spin_dot_;  // of the mass, principal axes
    Shell shell_;
    Quaternion q_;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: closed_form DIR\n";
        return 1;
    }
    const std::string dir = argv[1];
    const auto voltage = peers::read_rows<PerLimb>(dir + "/voltage.bin");
    const Decoder ready(peers::read_rows<Problem>(dir + "/problem.bin").at(0));
    peers::serve([&](std::vector<Row>& rows) {
        rows.resize(voltage.size() - 2);
        Decoder decoder = ready;
        rows[0] = decoder.begin(voltage.data());
        for (std::size_t k = 3; k < voltage.size(); ++k) rows[k - 2] = decoder.push(voltage[k]);
    });
}
