// The decoder in C++ with Eigen: the paper's equations as one would first write them down.
// Nothing is rearranged for speed or rounding, nothing is done badly on purpose.

#include <Eigen/Dense>
#include <cmath>

#include "protocol.hpp"

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using peers::kLimbs;
using peers::PerLimb;
using peers::Problem;
using peers::Row;
using LimbVector = Eigen::Matrix<double, kLimbs, 1>;
using LimbMatrix = Eigen::Matrix<double, kLimbs, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

// Gauss-Newton stops at a step of this size, m (rotations times half an edge), or after so many steps.
constexpr double kConvergedM = 1e-13;
constexpr int kIterations = 20;

Vector3d vector(const peers::Vector& v) { return {v[0], v[1], v[2]}; }

Matrix3d matrix(const peers::Matrix& m) {
    Matrix3d result;
    for (int i = 0; i < 3; ++i) result.row(i) = vector(m[i]).transpose();
    return result;
}

Matrix3d exponential(const Vector3d& phi) {
    const double angle = phi.norm();
    if (angle == 0.0) return Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, phi / angle).toRotationMatrix();
}

// Pose of the mass in the shell: r, shell axes, and phi with R_r = exp(phi).
struct Pose {
    Vector3d r = Vector3d::Zero();
    Vector3d phi = Vector3d::Zero();
};

// What the limbs say at one sample: everything in (3) and (8) but w*.
struct Sensed {
    Vector3d r, v, a_r, w_r, eps;
    Vector3d force;   // sum (f_i/m) e_i
    Vector3d torque;  // sum (f_i/m) t_i x e_i
    Matrix3d inertia, inertia_inverse;

    // Eq. (8).
    Vector3d rate_derivative(const Vector3d& w) const {
        const Vector3d total = w + w_r;
        return inertia_inverse * (torque - total.cross(inertia * total)) - eps - w.cross(w_r);
    }

    // Eq. (3) for R^T (a - g).
    Vector3d specific_force(const Vector3d& w, const Vector3d& w_dot) const {
        return force - a_r - w_dot.cross(r) - w.cross(w.cross(r)) - 2.0 * w.cross(v);
    }
};

class Decoupler {
public:
    explicit Decoupler(const Problem& problem)
        : length_(problem.limb_length_m),
          half_edge_(problem.half_edge_m),
          stiffness_(problem.stiffness_per_mass_per_s2),
          step_(1.0 / problem.sample_rate_hz),
          inertia_(matrix(problem.inertia_per_mass_m2)),
          gravity_(vector(problem.gravity_ground_m_s2)),
          attitude_(matrix(problem.initial_attitude)) {
        for (int i = 0; i < kLimbs; ++i) {
            t_[i] = vector(problem.mass_hinge_m[i]);
            b_[i] = vector(problem.shell_hinge_m[i]);
            drift_[i] = problem.zero_drift_v[i];
            sensitivity_[i] = problem.scale_per_mass_per_kg[i] * problem.gain_n_per_v[i];
            preload_[i] = problem.preload_per_mass_m_s2[i];
        }
    }

    // Takes nine voltages and gives the sample before them, once there are three.
    bool push(const PerLimb& voltage_v, Row& row) {
        // (10), (11)
        const LimbVector voltage = Eigen::Map<const LimbVector>(voltage_v.data());
        const LimbVector force = sensitivity_.cwiseProduct(voltage - drift_) + preload_;
        // (2)
        const LimbVector elongation = -force / stiffness_;
        const Pose after = pose(elongation, now_);
        const Pose before = before_, now = now_;
        const LimbVector now_force = now_force_;
        before_ = now_;
        now_ = after;
        now_force_ = force;
        if (++received_ < 3) return false;

        const Sensed sensed = sense(before, now, after, now_force);
        if (received_ > 3) {
            // (8) by Heun
            const Vector3d f0 = w_dot_;
            const Vector3d f1 = sensed.rate_derivative(w_ + step_ * f0);
            const Vector3d w = w_ + 0.5 * step_ * (f0 + f1);
            // (9): R' = R [w*]x with the mean rate of the step
            attitude_ = attitude_ * exponential(0.5 * step_ * (w_ + w));
            w_ = w;
        }
        w_dot_ = sensed.rate_derivative(w_);
        const Vector3d a = attitude_ * sensed.specific_force(w_, w_dot_) + gravity_;
        const Vector3d w_dot_ground = attitude_ * w_dot_;
        row = {a.x(), a.y(), a.z(), w_dot_ground.x(), w_dot_ground.y(), w_dot_ground.z()};
        return true;
    }

private:
    // The pose with the nine lengths L + elongation: least squares by Gauss-Newton from `pose`.
    Pose pose(const LimbVector& elongation, Pose pose) const {
        for (int iteration = 0; iteration < kIterations; ++iteration) {
            const Matrix3d rotation = exponential(pose.phi);
            LimbMatrix jacobian;
            LimbVector residual;
            for (int i = 0; i < kLimbs; ++i) {
                const Vector3d t = rotation * t_[i];
                const Vector3d limb = pose.r + t - b_[i];
                const Vector3d e = limb.normalized();
                // d l_i = e_i . dr + (t_i x e_i) . dphi
                jacobian.row(i) << e.transpose(), t.cross(e).transpose();
                residual[i] = length_ + elongation[i] - limb.norm();
            }
            // An ordinary product of this size would go to Eigen's kernel for large matrices, and cost a quarter more.
            const Eigen::Matrix<double, 6, 6> normal = jacobian.transpose().lazyProduct(jacobian);
            const Vector6d step = normal.llt().solve(jacobian.transpose() * residual);
            pose.r += step.head<3>();
            pose.phi += step.tail<3>();
            if (step.head<3>().norm() + half_edge_ * step.tail<3>().norm() < kConvergedM) break;
        }
        return pose;
    }

    Sensed sense(const Pose& before, const Pose& now, const Pose& after,
                 const LimbVector& force) const {
        const double h = step_;
        const Vector3d phi_dot = (after.phi - before.phi) / (2.0 * h);
        const Vector3d phi_ddot = (after.phi - 2.0 * now.phi + before.phi) / (h * h);
        const Matrix3d rotation = exponential(now.phi);
        Sensed sensed;
        sensed.r = now.r;
        sensed.v = (after.r - before.r) / (2.0 * h);
        sensed.a_r = (after.r - 2.0 * now.r + before.r) / (h * h);
        // From a rotation vector's rate to an angular velocity, to the first power of phi.
        sensed.w_r = phi_dot + 0.5 * now.phi.cross(phi_dot);
        sensed.eps = phi_ddot + 0.5 * now.phi.cross(phi_ddot);
        sensed.force.setZero();
        sensed.torque.setZero();
        for (int i = 0; i < kLimbs; ++i) {
            const Vector3d t = rotation * t_[i];
            const Vector3d e = (now.r + t - b_[i]).normalized();
            sensed.force += force[i] * e;
            sensed.torque += force[i] * t.cross(e);
        }
        sensed.inertia = rotation * inertia_ * rotation.transpose();
        sensed.inertia_inverse = sensed.inertia.inverse();
        return sensed;
    }

    std::array<Vector3d, kLimbs> t_, b_;
    LimbVector drift_, sensitivity_, preload_;
    double length_, half_edge_, stiffness_, step_;
    Matrix3d inertia_;
    Vector3d gravity_;

    long received_ = 0;
    Pose before_, now_;
    LimbVector now_force_ = LimbVector::Zero();
    Vector3d w_ = Vector3d::Zero(), w_dot_ = Vector3d::Zero();
    Matrix3d attitude_;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: eigen DIR\n";
        return 1;
    }
    const std::string dir = argv[1];
    const auto voltage = peers::read_rows<PerLimb>(dir + "/voltage.bin");
    const Decoupler ready(peers::read_rows<Problem>(dir + "/problem.bin").at(0));
    peers::serve([&](std::vector<Row>& rows) {
        rows.clear();
        rows.reserve(voltage.size());
        Decoupler decoupler = ready;
        Row row;
        for (const PerLimb& sample : voltage) {
            if (decoupler.push(sample, row)) rows.push_back(row);
        }
    });
}
