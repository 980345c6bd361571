// Measures and poses of a whole motion, as in `search.measures`, `.kinematics` and `.window`.
//
// Sums are in double precision and in one order; loops over joints or nodes are innermost, so that
// a compiler makes vectors of them without changing that order.
#pragma once
#include <algorithm>
#include <vector>

#include "functions.h"
#include "measures.h"

namespace microcosmos {

constexpr int FRAMES = 64, STROKES = 2, PLACES = 65, LEVELS = 32767;  // `archive.poses`

// Places of the other numbers of a summary.
enum Shown { SCALE, WINDOW_START, WINDOW_STOP, WINDOW_STROKES, STATUS, SHOWN };
enum Status { OK, NON_FINITE, SUPERSONIC };

// The observations of a rollout, and its summary.
struct Observed {
  int32_t height, width, steps, nodes, edges, joints, bodies, energetic;
  bool driven, varied, walled;                               // As of a rollout.
  const float* populations[9];                               // (height, width) each, at the end
  const float *uniform_force, *force_x, *force_y;            // (2), (height, width) each
  const int32_t* walls;                                      // (height, width)
  const float* positions;                                    // (node, 2) at the start
  const float* angles;                                       // (edge) at the start
  const int32_t *ends, *pairs;                               // (edge, 2) nodes, (joint, 2) edges
  const int32_t *member, *present;                           // (node) body; 1 or 0
  const float* boxes;                                        // (body, 2) at the start
  const float* collected;                                    // (node) at the end
  const float *rest_angle, *rest_length;                     // (step, joint), (step, edge)
  const float *centre, *path;                                // (step, 2), (step, node, 2)
  const float *speed, *node_speed, *held, *heading, *power;  // (step) each
  const float* curvature;                                    // (step, joint)
  const float *force, *box;                                  // (step, body, 2) each
  const float* clock;   // (step) the controller's time at the end of each step
  const float* scales;  // viscosity, length of the body, steps in a stroke or 0

  float* places;    // (PLACES, 2) of the centre
  float* frames;    // (FRAMES, node, 2) whole numbers from -LEVELS to LEVELS
  float* middles;   // (FRAMES, 2) of the body's extent
  float* shown;     // (SHOWN)
  float* measures;  // (MEASURE_COUNT)
};

namespace ISA {

class Summary {
 public:
  explicit Summary(const Observed& m) : m_(m), viscosity_(m.scales[0]), length_(m.scales[1]) {
    node_here_.assign(m.present, m.present + m.nodes);
    for (int e = 0; e < m.edges; e++)
      edge_here_.push_back(node_here_[m.ends[2 * e]] * node_here_[m.ends[2 * e + 1]]);
    for (int j = 0; j < m.joints; j++)
      joint_here_.push_back(edge_here_[m.pairs[2 * j]] * edge_here_[m.pairs[2 * j + 1]]);
    for (int n = m.nodes; n-- > 0;)
      if (m.present[n]) leader_ = std::min(m.member[n], leader_ < 0 ? m.bodies : leader_);
    leader_ = std::max(leader_, 0);
    for (int n = 0; n < m.nodes; n++) {
      nodes_ += node_here_[n];
      for (int axis : {0, 1})
        begun_[axis] +=
            node_here_[n] * (m.positions[2 * n + axis] + away(m.boxes, m.member[n], axis));
    }
    for (double& place : begun_) place /= larger(nodes_, 1);
    stroke();
    cosines();
  }

  void write() {
    translation(), turning(), means(), effort(), curvature(), symmetry(), impulse(), swimming();
    if (m_.joints) waves();
    shape();
    poses();
    for (int64_t k = 0; k < PLACES; k++) {
      const int64_t step = (2 * k * m_.steps + PLACES - 1) / (2 * (PLACES - 1));
      for (int axis : {0, 1})
        m_.places[2 * k + axis] = float(step ? after(int(step) - 1, axis) : begun_[axis]);
    }
    for (int i = 0; i < MEASURE_COUNT; i++) m_.measures[i] = float(found_[i]);
    m_.shown[STATUS] = float(status());
  }

 private:
  using Doubles = std::vector<double>;
  static constexpr double TINY = 1e-20;

  static double root(double x) { return __builtin_sqrt(x); }
  static double norm(double x, double y) { return root(x * x + y * y + 1e-24); }
  // The larger of two numbers; NaN stays NaN.
  static double larger(double a, double b) { return a >= b ? a : b > a ? b : a + b; }
  static double down(double x) {
    const double whole = double(int64_t(x));
    return whole > x ? whole - 1 : whole;
  }
  static bool finite(double x) { return x - x == 0; }

  // Return the distance in cells along an axis from the leader's box to that of a body.
  double away(const float* boxes, int body, int axis) const {
    return (double(boxes[2 * body + axis]) - boxes[2 * leader_ + axis]) * side(axis);
  }
  double side(int axis) const { return axis ? m_.width : m_.height; }
  const float* box(int t) const { return m_.box + 2 * size_t(t) * m_.bodies; }

  // Return the distance in cells between the leader's boxes at the start and after step t.
  double carried(int t, int axis) const {
    return (double(box(t)[2 * leader_ + axis]) - m_.boxes[2 * leader_ + axis]) * side(axis);
  }

  // Return the place of the centre after step t, from the leader's box at the start.
  double after(int t, int axis) const { return m_.centre[2 * t + axis] + carried(t, axis); }

  // Return the place of the centre after `step` steps, interpolated between whole ones.
  double centre(double step, int axis) const {
    const int before = step < m_.steps ? int(step) : m_.steps - 1;
    const double low = before ? after(before - 1, axis) : begun_[axis];
    return low + (step - before) * (after(before, axis) - low);
  }

  // Return the place of a node after step t, from the leader's box: near, so that a float holds it.
  double place(int t, int n, int axis) const {
    return m_.path[2 * (size_t(t) * m_.nodes + n) + axis] + away(box(t), m_.member[n], axis);
  }

  // Return the strokes done after a number of steps.
  double strokes(int step) const { return step && period_ > 0 ? m_.clock[step - 1] / period_ : 0; }

  // Return the time at which `done` strokes are done, in steps.
  double when(double done) const {
    int low = 0, high = m_.steps;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (strokes(middle) <= done ? low : high) = middle;
    }
    const double before = strokes(low), passed = strokes(high) - before;
    if (!(passed > 0)) return high;
    const double share = (done - before) / passed;
    return low + (share > 0 ? std::min(share, 1.0) : 0);  // NaN counts as 0.
  }

  // Find the last two whole strokes, as in `search.window`.
  void stroke() {
    period_ = m_.scales[2], stop_ = m_.steps;
    const double last = strokes(m_.steps) + 1e-3;
    done_ = last > 0 && last < 1e9 ? down(last) : 0;
    if (done_ < STROKES) return;
    start_ = done_ == STROKES ? 0 : int(when(done_ - STROKES) + 0.5);
    stop_ = std::max(1, int(when(done_) + 0.5)), window_ = STROKES;
    if (start_ >= stop_) start_ = stop_ - 1;
  }

  // Find the cosines of whole 64ths of a turn from those of halved angles, without the C library.
  void cosines() {
    double c = 0;  // Of a quarter turn, then of an eighth, ...
    for (int part = 4; part < FRAMES; part *= 2) c = root((1 + c) / 2);
    const double s = root(1 - c * c);
    double x = 1, y = 0;
    for (double& one : cosine_) {
      one = x;
      const double next = x * c - y * s;
      y = x * s + y * c, x = next;
    }
  }

  // Return the step of a frame, from 0.
  int frame(int64_t number) const {
    const int64_t passed = (number + 1) * (stop_ - start_);
    const int64_t done = start_ + (2 * passed + FRAMES) / (2 * FRAMES);
    return done < 1 ? 0 : int(done) - 1;
  }

  void translation() {
    double path = 0, x = begun_[0], y = begun_[1];
    for (int t = 0; t < m_.steps; t++) {
      const double next_x = after(t, 0), next_y = after(t, 1);
      path += norm(next_x - x, next_y - y), x = next_x, y = next_y;
    }
    found_[DISPLACEMENT] = norm(x - begun_[0], y - begun_[1]);
    found_[PATH_LENGTH] = path, found_[MEAN_SPEED] = path / m_.steps;
    found_[STRAIGHTNESS] = found_[DISPLACEMENT] / larger(path, 1e-12);
  }

  void turning() {
    double start = 0, count = 0, turned = 0;
    for (int e = 0; e < m_.edges; e++)
      start += edge_here_[e] * m_.angles[e], count += edge_here_[e];
    if (count > 0) start /= count;
    double before = start;
    for (int t = 0; t < m_.steps; t++) {
      const double change = m_.heading[t] - before;
      turned += change < 0 ? -change : change, before = m_.heading[t];
    }
    found_[TURNING] = turned, found_[ROTATION] = before - start;
  }

  void means() {
    double held = 0, speed = 0, power = 0, fastest = 0;
    for (int t = 0; t < m_.steps; t++) {
      held += m_.held[t], speed += m_.node_speed[t], power += m_.power[t];
      fastest = larger(fastest, m_.speed[t]);
    }
    found_[LIMITED] = held / m_.steps, found_[POWER] = power /= m_.steps;
    found_[REYNOLDS] = speed / m_.steps * length_ / viscosity_;
    found_[MACH] = fastest * SOUND;
    const double pace = found_[DISPLACEMENT] / m_.steps;
    found_[EFFICIENCY] = power > TINY ? viscosity_ * pace * pace / power : power - power;
    found_[NODES] = nodes_;
    for (int n = 0; n < m_.nodes && m_.energetic; n++) found_[ENERGY] += m_.collected[n];
  }

  // Return the sum of squared changes of rest shapes from one step to the next.
  double changed(const float* rest, const Doubles& here) const {
    Doubles sums(here.size());
    const size_t count = here.size();
    for (int t = 1; t < m_.steps; t++) {
      const float *before = rest + (t - 1) * count, *now = rest + t * count;
      for (size_t i = 0; i < count; i++) {
        const double change = double(now[i]) - before[i];
        sums[i] += change * change;
      }
    }
    return over(sums, here);
  }

  static double over(const Doubles& values, const Doubles& here) {
    double sum = 0;
    for (size_t i = 0; i < values.size(); i++) sum += here[i] > 0 ? values[i] : 0;
    return sum;
  }

  void effort() {
    found_[BENDING_EFFORT] = changed(m_.rest_angle, joint_here_);
    found_[STRETCHING_EFFORT] = changed(m_.rest_length, edge_here_);
  }

  // Find the mean and the standard deviation of the size of the curvature.
  void curvature() {
    const size_t J = joint_here_.size();
    for (double here : joint_here_) joints_ += here;
    if (joints_ == 0) return;
    Doubles sizes(J), squares(J);
    for (int t = 0; t < m_.steps; t++) {
      const float* bends = m_.curvature + t * J;
      for (size_t j = 0; j < J; j++) sizes[j] += bends[j] < 0 ? -bends[j] : bends[j];
    }
    const double count = joints_ * m_.steps, mean = over(sizes, joint_here_) / count;
    for (int t = 0; t < m_.steps; t++) {
      const float* bends = m_.curvature + t * J;
      for (size_t j = 0; j < J; j++) {
        const double off = (bends[j] < 0 ? -bends[j] : bends[j]) - mean;
        squares[j] += off * off;
      }
    }
    found_[CURVATURE_MEAN] = mean;
    found_[CURVATURE_SPREAD] = root(over(squares, joint_here_) / count + 1e-24);
  }

  void symmetry() {
    const int J = m_.joints;
    Doubles mean(J), product(J), square(J), change(J), mirrored(J);
    std::vector<int> mirror;
    std::vector<int> order;  // Joints that are present.
    for (int j = 0; j < J; j++)
      if (joint_here_[j] > 0) order.push_back(j);
    for (int j = 0, rank = 0; j < J; j++) {
      mirror.push_back(joint_here_[j] > 0 ? order[order.size() - 1 - rank] : j);
      rank += joint_here_[j] > 0;
    }
    for (int t = 0; t < m_.steps; t++)
      for (int j = 0; j < J; j++) mean[j] += m_.curvature[t * size_t(J) + j];
    for (double& one : mean) one /= m_.steps;
    for (int t = 0; t < m_.steps; t++) {
      for (int j = 0; j < J; j++) change[j] = m_.curvature[t * size_t(J) + j] - mean[j];
      for (int j = 0; j < J; j++) mirrored[j] = change[mirror[j]];
      for (int j = 0; j < J; j++) {
        product[j] += change[j] * mirrored[j], square[j] += change[j] * change[j];
      }
    }
    found_[SYMMETRY] = over(product, joint_here_) / larger(over(square, joint_here_), TINY);
  }

  void impulse() {
    Doubles given(2 * m_.bodies);
    for (int t = 0; t < m_.steps; t++)
      for (int b = 0; b < m_.bodies; b++) {
        const float* force = m_.force + 2 * (size_t(t) * m_.bodies + b);
        given[2 * b] += force[0], given[2 * b + 1] += force[1];
        found_[IMPULSE] = larger(found_[IMPULSE], norm(given[2 * b], given[2 * b + 1]));
      }
  }

  // Find speed, stride, advance along x and cost of transport over whole strokes after the first.
  void swimming() {
    const bool swam = done_ >= 2;
    const double from = swam ? when(1) : 0, to = swam ? when(done_) : m_.steps;
    const double moved = norm(centre(to, 0) - centre(from, 0), centre(to, 1) - centre(from, 1));
    const double lengths = moved / length_;
    if (swam) {
      found_[ADVANCE] = 1000 * (centre(to, 0) - centre(from, 0)) / length_ / larger(to - from, 1);
      found_[SPEED] = 1000 * lengths / larger(to - from, 1);
      found_[STRIDE] = lengths / (done_ - 1);
    }
    double spent = 0;
    for (int t = 0; t < m_.steps; t++) {
      const double begin = from > t ? from : t, end = to < t + 1 ? to : t + 1;
      if (end > begin) spent += (end - begin) * m_.power[t];
    }
    found_[COST_OF_TRANSPORT] = spent / larger(lengths, 1e-3);
  }

  // Find beats, wave number and direction of the curvature in the window; see `measures.waves`.
  void waves() {
    const int J = m_.joints;
    Doubles change(size_t(FRAMES) * J), mean(J), real(J), imaginary(J), best, other;
    for (int f = 0; f < FRAMES; f++)
      for (int j = 0; j < J; j++) mean[j] += m_.curvature[frame(f) * size_t(J) + j];
    for (double& one : mean) one /= FRAMES;
    for (int f = 0; f < FRAMES; f++)
      for (int j = 0; j < J; j++)
        change[f * size_t(J) + j] = m_.curvature[frame(f) * size_t(J) + j] - mean[j];
    double whole = 0, weighed = 0, strongest = -1;
    for (int k = 1; k <= FRAMES / 2; k++) {
      std::fill(real.begin(), real.end(), 0), std::fill(imaginary.begin(), imaginary.end(), 0);
      for (int f = 0; f < FRAMES; f++) {
        const double c = cosine_[k * f % FRAMES];
        const double s = cosine_[(k * f + FRAMES - FRAMES / 4) % FRAMES];
        const double* row = change.data() + f * size_t(J);
        for (int j = 0; j < J; j++) real[j] += c * row[j], imaginary[j] -= s * row[j];
      }
      double power = 0;
      for (int j = 0; j < J; j++) power += real[j] * real[j] + imaginary[j] * imaginary[j];
      whole += power, weighed += power * k / STROKES;
      if (power > strongest) strongest = power, best = real, other = imaginary;
    }
    found_[BEATS] = weighed / larger(whole, TINY) * window_ / STROKES;
    if (!(whole <= TINY)) travel(best, other);
  }

  void travel(const Doubles& real, const Doubles& imaginary) {
    double sizes = TINY, steps = TINY, turned = 0;
    for (int j = 0; j + 1 < m_.joints && !real.empty(); j++) {
      const bool along = m_.pairs[2 * j + 1] == m_.pairs[2 * j + 2];
      if (!along || !(joint_here_[j] * joint_here_[j + 1] > 0)) continue;
      const double x = (real[j] + real[j + 1]) / 2, y = (imaginary[j] + imaginary[j + 1]) / 2;
      const double dx = real[j + 1] - real[j], dy = imaginary[j + 1] - imaginary[j];
      sizes += x * x + y * y, steps += dx * dx + dy * dy, turned += x * dy - y * dx;
    }
    const double size = root(sizes), step = root(steps);
    double lengths = 0, edges = 0;
    const float* first = m_.path + 2 * size_t(frame(0)) * m_.nodes;
    for (int e = 0; e < m_.edges; e++) {
      if (!(edge_here_[e] > 0)) continue;
      const float *one = first + 2 * m_.ends[2 * e], *other = first + 2 * m_.ends[2 * e + 1];
      lengths += norm(double(other[0]) - one[0], double(other[1]) - one[1]), edges++;
    }
    const double waves = angle(step, 2 * size) / 3.141592653589793;
    found_[WAVE_NUMBER] = waves * length_ * edges / larger(lengths, 1e-12);
    found_[WAVE_DIRECTION] = -turned / (size * step);
  }

  static double angle(double y, double x) { return arctangent(all(float(y)), all(float(x)))[0]; }

  // Find the body's axes and its excursion across its path, in the window.
  void shape() {
    const int N = m_.nodes;
    double xx = 0, yy = 0, xy = 0, swung = 0;
    const double moved[2] = {centre(stop_, 0) - centre(start_ ? start_ : 1, 0),
                             centre(stop_, 1) - centre(start_ ? start_ : 1, 1)};
    const double distance = norm(moved[0], moved[1]);
    Doubles low(N, 1e30), high(N, -1e30);
    for (int f = 0; f < FRAMES; f++) {
      const int t = frame(f);
      double mean[2] = {0, 0};
      for (int n = 0; n < N; n++)
        for (int axis : {0, 1}) mean[axis] += node_here_[n] > 0 ? place(t, n, axis) : 0;
      for (int n = 0; n < N; n++) {
        if (!(node_here_[n] > 0)) continue;
        const double x = place(t, n, 0) - mean[0] / nodes_, y = place(t, n, 1) - mean[1] / nodes_;
        xx += x * x, yy += y * y, xy += x * y;
        const double across = (moved[0] * y - moved[1] * x) / distance;
        low[n] = across < low[n] ? across : low[n], high[n] = larger(high[n], across);
      }
    }
    for (int n = 0; n < N; n++)
      if (node_here_[n] > 0) swung = larger(swung, high[n] - low[n]);
    const double half = root((xx - yy) * (xx - yy) / 4 + xy * xy + TINY), middle = (xx + yy) / 2;
    found_[ASPECT] = root(larger(middle - half, 0) / (middle + half) + TINY);
    float s, c;
    sine_cosine_far(float(angle(2 * xy, xx - yy + TINY) / 2), s, c);
    const double ahead = c * moved[0] + s * moved[1], aside = c * moved[1] - s * moved[0];
    found_[HEADING_ANGLE] = angle(aside < 0 ? -aside : aside, (ahead < 0 ? -ahead : ahead) + TINY);
    found_[STROUHAL] = window_ * swung / larger(distance, 1e-3 * length_);
  }

  // Store positions about the middle of their range in each frame, in units that fit 16 bits.
  void poses() {
    constexpr float ENDLESS = __builtin_inff();
    const int N = m_.nodes;
    float range = 0;
    for (int f = 0; f < FRAMES; f++)
      for (int axis : {0, 1}) {
        float low = ENDLESS, high = -ENDLESS;
        for (int n = 0; n < N; n++) {
          if (!m_.present[n]) continue;
          const float at = float(place(frame(f), n, axis));
          low = at < low ? at : low, high = at > high ? at : high;
        }
        if (nodes_ == 0) low = high = 0;
        middle_[2 * f + axis] = (low + high) / 2;
        range = high - low > range ? high - low : range;
        m_.middles[2 * f + axis] = float(middle_[2 * f + axis] + carried(frame(f), axis));
      }
    range = range / 2 > 1e-6f ? range / 2 : 1e-6f;
    const float scale = range / float(LEVELS);
    for (int f = 0; f < FRAMES; f++)
      for (int i = 0; i < 2 * N; i++) {
        const float at = float(place(frame(f), i / 2, i & 1));
        float units = (at - middle_[2 * f + (i & 1)]) / scale;
        units = units > LEVELS ? LEVELS : units > -LEVELS ? units : -LEVELS;
        m_.frames[2 * size_t(f) * N + i] =
            // Adding 1.5 * 2^23 rounds to the nearest whole number.
            m_.present[i / 2] ? (units + 12582912.0f) - 12582912.0f : 0.0f;
      }
    m_.shown[SCALE] = scale;
    m_.shown[WINDOW_START] = float(start_), m_.shown[WINDOW_STOP] = float(stop_);
    m_.shown[WINDOW_STROKES] = float(window_);
  }

  // Return the status of the motion; the flow at its end counts.
  Status status() const {
    const float* const* f = m_.populations;
    float fastest = 0;
    bool valid = true;
    for (size_t i = 0; i < size_t(m_.height) * m_.width; i++) {
      const float across = f[5][i] - f[6][i], along = f[7][i] - f[8][i];
      float x = (f[1][i] - f[2][i]) + (across + along);
      float y = (f[3][i] - f[4][i]) + (across - along);
      // Half a step of the surroundings' force has acted; see `moments`.
      if (!m_.walled || !m_.walls[i]) {
        if (m_.driven) x += 0.5f * m_.uniform_force[0], y += 0.5f * m_.uniform_force[1];
        if (m_.varied) x += 0.5f * m_.force_x[i], y += 0.5f * m_.force_y[i];
      }
      const float straight = (f[1][i] + f[2][i]) + (f[3][i] + f[4][i]);
      const float density =
          1.0f + (f[0][i] + straight + ((f[5][i] + f[6][i]) + (f[7][i] + f[8][i])));
      const float square = (x * x + y * y) / (density * density);
      fastest = square > fastest ? square : fastest, valid &= square - square == 0;
    }
    for (double one : found_) valid &= finite(float(one));
    if (!valid) return NON_FINITE;
    return larger(found_[MACH], root(fastest) * SOUND) < 1 ? OK : SUPERSONIC;
  }

  static constexpr double SOUND = 1.7320508075688772;  // One over the lattice's speed of sound.

  const Observed& m_;
  double viscosity_, length_, period_ = 0, nodes_ = 0, joints_ = 0, done_ = 0;
  double begun_[2] = {0, 0}, cosine_[FRAMES], found_[MEASURE_COUNT] = {};
  float middle_[2 * FRAMES];  // Of each frame, from the leader's box.
  int leader_ = -1;           // The first body of which a node has grown.
  int start_ = 0, stop_ = 0, window_ = 0;
  Doubles node_here_, edge_here_, joint_here_;
};

}  // namespace ISA
}  // namespace microcosmos
