// One call of Pinocchio a sample, on shell and mass as two free bodies: inverse (rnea) or forward dynamics (aba) of the
// recorded motion. What a user would spend on the dynamics alone, the state being known.

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "protocol.hpp"

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;
using peers::Problem;
using peers::Row;

constexpr int kQ = 7;  // coordinates of a free body
constexpr int kV = 6;  // its degrees of freedom

// A row of states.bin: MuJoCo's coordinates and velocities of shell and mass, the shell's acceleration.
struct State {
    double qpos[2][kQ];  // position, quaternion w x y z
    double qvel[2][kV];  // velocity in ground axes, rate in body axes
    double qacc[kV];     // likewise
};

Vector3d vector(const double* v) { return {v[0], v[1], v[2]}; }

Quaterniond attitude(const double* qpos) { return {qpos[3], qpos[4], qpos[5], qpos[6]}; }

// One sample as Pinocchio wants it: everything in body axes, linear accelerations less w x v.
struct Sample {
    VectorXd q{2 * kQ}, v{2 * kV}, a{2 * kV}, tau{2 * kV};
};

class Engine {
public:
    explicit Engine(const std::string& dir)
        : problem_(peers::read_rows<Problem>(dir + "/problem.bin").at(0)) {
        for (int i = 0; i < 3; ++i) inertia_.row(i) = vector(problem_.inertia_per_mass_m2[i].data());
        const pinocchio::JointModelFreeFlyer free;
        const auto place = pinocchio::SE3::Identity();
        const Matrix3d shell_inertia = problem_.shell_inertia_kg_m2 * Matrix3d::Identity();
        const auto shell = model_.addJoint(0, free, place, "shell");
        model_.appendBodyToJoint(
            shell, pinocchio::Inertia(problem_.shell_mass_kg, Vector3d::Zero(), shell_inertia), place);
        const auto mass = model_.addJoint(0, free, place, "mass");
        model_.appendBodyToJoint(
            mass, pinocchio::Inertia(problem_.mass_kg, Vector3d::Zero(), problem_.mass_kg * inertia_),
            place);
        model_.gravity.linear() = vector(problem_.gravity_ground_m_s2.data());
        data_ = pinocchio::Data(model_);

        states_ = peers::read_rows<State>(dir + "/states.bin");
        wrenches_ = peers::read_rows<Row>(dir + "/wrench.bin");
        states_ = {states_.begin() + 1, states_.end() - 1};
        for (std::size_t i = 0; i < states_.size(); ++i) samples_.push_back(sample(states_[i], wrenches_[i]));
    }

    // Keeps the force that the mass would need.
    void rnea(std::vector<Row>& rows) {
        rows.clear();
        for (const Sample& s : samples_) {
            keep(pinocchio::rnea(model_, data_, s.q, s.v, s.a), rows);
        }
    }

    // Keeps the acceleration of the mass.
    void aba(std::vector<Row>& rows) {
        rows.clear();
        for (const Sample& s : samples_) {
            keep(pinocchio::aba(model_, data_, s.q, s.v, s.tau, pinocchio::Convention::LOCAL), rows);
        }
    }

    // The force needed for the acceleration fed, less what the limbs give, over the mass: what was fed too much. The
    // acceleration fed less that is the mass's, whatever was fed.
    void finish_rnea(std::vector<Row>& rows) const {
        const Matrix3d inverse = inertia_.inverse();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const State& state = states_[i];
            const Quaterniond turn = attitude(state.qpos[1]);
            const Vector3d force = vector(&rows[i][0]) / problem_.mass_kg - vector(&wrenches_[i][0]);
            const Vector3d torque = vector(&rows[i][3]) / problem_.mass_kg - vector(&wrenches_[i][3]);
            set(rows[i], vector(state.qacc) - turn * force,
                turn * (vector(state.qacc + 3) - inverse * torque));
        }
    }

    void finish_aba(std::vector<Row>& rows) const {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Quaterniond turn = attitude(states_[i].qpos[1]);
            const auto v = samples_[i].v.tail<kV>();
            const Vector3d a = vector(&rows[i][0]) + v.tail<3>().cross(v.head<3>());
            set(rows[i], turn * a, turn * vector(&rows[i][3]));
        }
    }

private:
    Sample sample(const State& state, const Row& wrench) const {
        Sample s;
        for (int body = 0; body < 2; ++body) {
            const double *qpos = state.qpos[body], *qvel = state.qvel[body];
            const Quaterniond turn = attitude(qpos);
            const Vector3d velocity = turn.conjugate() * vector(qvel), rate = vector(qvel + 3);
            s.q.segment<kQ>(kQ * body) << vector(qpos), turn.coeffs();
            s.v.segment<kV>(kV * body) << velocity, rate;
            // Shell and mass are fed the same acceleration.
            s.a.segment<kV>(kV * body) << turn.conjugate() * vector(state.qacc) - rate.cross(velocity),
                vector(state.qacc + 3);
        }
        const Vector3d drive = attitude(state.qpos[0]).conjugate() *
                               (vector(state.qacc) - vector(problem_.gravity_ground_m_s2.data()));
        s.tau << problem_.shell_mass_kg * drive, problem_.shell_inertia_kg_m2 * vector(state.qacc + 3),
            problem_.mass_kg * vector(&wrench[0]), problem_.mass_kg * vector(&wrench[3]);
        return s;
    }

    static void keep(const VectorXd& outcome, std::vector<Row>& rows) {
        rows.emplace_back();
        Eigen::Map<Eigen::Matrix<double, kV, 1>>(rows.back().data()) = outcome.tail<kV>();
    }

    static void set(Row& row, const Vector3d& linear, const Vector3d& angular) {
        row = {linear.x(), linear.y(), linear.z(), angular.x(), angular.y(), angular.z()};
    }

    Problem problem_;
    Matrix3d inertia_;
    pinocchio::Model model_;
    pinocchio::Data data_;
    std::vector<State> states_;
    std::vector<Row> wrenches_;
    std::vector<Sample> samples_;
};

}  // namespace

int main(int argc, char** argv) {
    const std::string algorithm = argc == 3 ? argv[1] : "";
    if (algorithm != "rnea" && algorithm != "aba") {
        std::cerr << "usage: pinocchio rnea|aba DIR\n";
        return 1;
    }
    Engine engine(argv[2]);
    if (algorithm == "rnea") {
        peers::serve([&](auto& rows) { engine.rnea(rows); }, [&](auto& rows) { engine.finish_rnea(rows); });
    } else {
        peers::serve([&](auto& rows) { engine.aba(rows); }, [&](auto& rows) { engine.finish_aba(rows); });
    }
}
