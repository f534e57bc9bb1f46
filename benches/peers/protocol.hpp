// What the C++ peers share: the exported problem and the line protocol of benches/examples/serve.
#pragma once

#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

constexpr int kLimbs = 9;

// Linear, then angular acceleration of one sample, ground axes.
using Row = std::array<double, 6>;
using Vector = std::array<double, 3>;
using PerLimb = std::array<double, kLimbs>;
using Matrix = std::array<Vector, 3>;  // by rows

// problem.bin: the fields of problem.json, one after the other.
struct Problem {
    double samples, sample_rate_hz, limb_length_m, half_edge_m;
    std::array<Vector, kLimbs> direction_shell, mass_hinge_m, shell_hinge_m;
    PerLimb gain_n_per_v, zero_drift_v, scale_per_mass_per_kg;
    Matrix inertia_per_mass_m2;
    double stiffness_per_mass_per_s2;
    PerLimb preload_per_mass_m_s2;
    Vector gravity_ground_m_s2;
    Matrix initial_attitude;
    double mass_kg, shell_mass_kg, shell_inertia_kg_m2;
};
static_assert(sizeof(Problem) == 146 * sizeof(double), "doubles only, so that it can be read as it is");

// Rows of little-endian doubles, the machine's own: T is made of doubles.
template <class T>
std::vector<T> read_rows(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error("cannot read " + path);
    const auto size = static_cast<std::size_t>(file.tellg());
    if (size % sizeof(T) != 0) throw std::runtime_error(path + " ends within a row");
    std::vector<T> rows(size / sizeof(T));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(rows.data()), static_cast<std::streamsize>(size));
    return rows;
}

inline void write_rows(const std::string& path, const std::vector<Row>& rows) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(rows.data()),
               static_cast<std::streamsize>(rows.size() * sizeof(Row)));
    if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

// Answers requests until "quit". `decode(rows)` clears and fills rows, and is what is timed; `finish(rows)` makes
// accelerations of them where they are something else.
template <class Decode, class Finish>
void serve(Decode&& decode, Finish&& finish) {
    std::vector<Row> rows;
    std::string request, argument;
    while (std::cin >> request && request != "quit" && std::cin >> argument) {
        if (request == "answer") {
            decode(rows);
            finish(rows);
            write_rows(argument, rows);
            std::printf("%zu\n", rows.size());
        } else if (request == "time") {
            const int repeats = std::stoi(argument);
            decode(rows);  // another peer has had the caches
            const auto start = std::chrono::steady_clock::now();
            for (int i = 0; i < repeats; ++i) {
                decode(rows);
                // The rows must be written each time, for all that the compiler knows.
                asm volatile("" : : "g"(rows.data()) : "memory");
            }
            const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
            std::printf("%.9e\n", elapsed.count() / repeats);
        } else {
            throw std::runtime_error("no such request: " + request);
        }
        std::fflush(stdout);
    }
}

template <class Decode>
void serve(Decode&& decode) {
    serve(decode, [](std::vector<Row>&) {});
}

}  // namespace peers
