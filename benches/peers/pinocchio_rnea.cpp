// One inverse dynamics of Pinocchio a sample, on the mass as a free body: the question of mujoco_inverse put to a library that is
// compiled into the program. State and limb forces are given.

#include <pinocchio/algorithm/rnea.hpp>

#include "protocol.hpp"

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
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
constexpr int kMass = 1;

Vector3d vector(const double* v) { return {v[0], v[1], v[2]}; }

Quaterniond attitude(const double* qpos) { return {qpos[3], qpos[4], qpos[5], qpos[6]}; }

// One sample as Pinocchio wants it: everything in body axes, linear accelerations less w x v.
struct Sample {
    Eigen::VectorXd q{kQ}, v{kV}, a{kV};
};

class Engine {
public:
    explicit Engine(const std::string& dir)
        : problem_(peers::read_rows<Problem>(dir + "/problem.bin").at(0)) {
        for (int i = 0; i < 3; ++i) inertia_.row(i) = vector(problem_.inertia_per_mass_m2[i].data());
        const auto place = pinocchio::SE3::Identity();
        const auto mass = model_.addJoint(0, pinocchio::JointModelFreeFlyer(), place, "mass");
        const pinocchio::Inertia inertia(problem_.mass_kg, Vector3d::Zero(), problem_.mass_kg * inertia_);
        model_.appendBodyToJoint(mass, inertia, place);
        model_.gravity.linear() = vector(problem_.gravity_ground_m_s2.data());
        data_ = pinocchio::Data(model_);

        states_ = peers::read_rows<State>(dir + "/states.bin");
        wrenches_ = peers::read_rows<Row>(dir + "/wrench.bin");
        states_ = {states_.begin() + 1, states_.end() - 1};
        for (const State& state : states_) samples_.push_back(sample(state));
    }

    // Keeps the force that the mass would need.
    void decode(std::vector<Row>& rows) {
        rows.clear();
        for (const Sample& s : samples_) {
            rows.emplace_back();
            Eigen::Map<Eigen::Matrix<double, kV, 1>>(rows.back().data()) =
                pinocchio::rnea(model_, data_, s.q, s.v, s.a);
        }
    }

    // The force needed for the acceleration fed, less what the limbs give, over the mass: what was fed too much. The
    // acceleration fed less that is the mass's, whatever was fed.
    void finish(std::vector<Row>& rows) const {
        const Matrix3d inverse = inertia_.inverse();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const State& state = states_[i];
            const Quaterniond turn = attitude(state.qpos[kMass]);
            const Vector3d force = vector(&rows[i][0]) / problem_.mass_kg - vector(&wrenches_[i][0]);
            const Vector3d torque = vector(&rows[i][3]) / problem_.mass_kg - vector(&wrenches_[i][3]);
            const Vector3d a = vector(state.qacc) - turn * force;
            const Vector3d w_dot = turn * (vector(state.qacc + 3) - inverse * torque);
            rows[i] = {a.x(), a.y(), a.z(), w_dot.x(), w_dot.y(), w_dot.z()};
        }
    }

private:
    static Sample sample(const State& state) {
        const double *qpos = state.qpos[kMass], *qvel = state.qvel[kMass];
        const Quaterniond turn = attitude(qpos);
        const Vector3d velocity = turn.conjugate() * vector(qvel), rate = vector(qvel + 3);
        Sample s;
        s.q << vector(qpos), turn.coeffs();
        s.v << velocity, rate;
        // The shell's acceleration.
        s.a << turn.conjugate() * vector(state.qacc) - rate.cross(velocity), vector(state.qacc + 3);
        return s;
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
    if (argc != 2) {
        std::cerr << "usage: pinocchio_rnea DIR\n";
        return 1;
    }
    Engine engine(argv[1]);
    peers::serve([&](auto& rows) { engine.decode(rows); }, [&](auto& rows) { engine.finish(rows); });
}
