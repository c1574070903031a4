#pragma once
/// Walls, cylinders and points compete to explain echoes.
#include <optional>
#include <span>
#include <vector>

#include "core/contour.hpp"
#include "mapping/estimates.hpp"
#include "mapping/mapper_parameters.hpp"

namespace noctule::mapping {

/// An object of the map and what speaks for it.
struct Object {
  EchoFit fit;
  std::vector<int> members;  ///< slots of the echoes that shape it
  Evidence evidence;         ///< of the members
  double gain = 0.0;         ///< sum over members of the log likelihood ratio to the best other explanation
  bool has_news = false;     ///< members since the last fit
};

/// The set of objects that best explains a set of echoes (EchoModel), kept while echoes come and go.
///
/// `grow`: the peaks of the Hough accumulators, refined on the echoes, are candidates. The one that adds most to the
/// likelihood, beyond what the objects before it explain, is taken, and its echoes leave the accumulators; and so on.
/// `settle`: all objects share out all echoes anew and are refitted; those that claim the same place are merged; the
/// weakest is dropped while too little is left to it.
///
/// Two things keep the corners and the noise from becoming walls: points are among the rivals, and an echo from behind
/// an object contradicts it, since a ranger hears the nearest surface. What is contradicted too often is refused; and
/// two parallel walls one close before the other, or two solids inside each other, are one object seen from poses with
/// errors.
class Competition {
 public:
  Competition(const MapperParameters& parameters, const Extent& extent);

  /// Puts an echo into a slot: the one after the last, or an old one, whose echo is forgotten. The objects may take it
  /// as a member; else it votes.
  void put(int slot, const SonarArc& arc);
  /// Enlarges the accumulators when more than a few new echoes lie outside.
  void cover();
  /// Looks for objects among the echoes that none explains, where it has not looked in vain since the last settling.
  /// \return whether there were any
  bool grow();
  void settle();
  /// One Gauss-Newton step of every object that has new members.
  void follow();
  /// Forgets all objects.
  void restart();

  [[nodiscard]] const std::vector<Object>& objects() const { return objects_; }
  [[nodiscard]] int unexplained() const { return unexplained_; }  ///< echoes that belong to no object
  /// Normalised, without a stamp; walls first found first.
  [[nodiscard]] ContourMap map() const;

 private:
  static constexpr int kNobody = -1;

  // echoes and their owners
  void remove(int slot);
  void claim(int slot);
  void share_out();
  void set_owner(int slot, int owner);
  void update_votes();
  void cast(int slot, double weight);
  void allow_all();

  // candidates (candidates.cpp)
  [[nodiscard]] std::optional<Object> best_wall();
  [[nodiscard]] std::optional<Object> best_round();
  [[nodiscard]] std::optional<Object> refined(const Reflector& start) const;
  [[nodiscard]] std::optional<Object> refined_round(const Cylinder& start) const;
  [[nodiscard]] std::vector<int> supporters(const EchoFit& fit, double window) const;
  [[nodiscard]] EchoFit simplest(const EchoFit& fit, std::span<const int> members) const;
  [[nodiscard]] EchoFit refitted(const EchoFit& fit, std::span<const int> members) const;
  [[nodiscard]] double log_likelihood(const EchoFit& fit, std::span<const int> members) const;
  [[nodiscard]] bool still_worth(Object& object) const;
  void accept(Object object);

  // judgement
  void measure(Object& object) const;
  [[nodiscard]] bool supported(const Object& object) const;
  [[nodiscard]] int contradictions(const Object& object) const;
  [[nodiscard]] int readings_before(const Object& wall,
                                    const Object& other) const;  ///< of `other`, within the wall's ends
  [[nodiscard]] bool claim_same_place(const Object& a, const Object& b) const;
  bool merge_two();
  bool drop_weakest();

  MapperParameters parameters_;
  EchoModel model_;
  Extent extent_;
  LineVotes lines_;
  CircleVotes circles_;

  // by slot
  std::vector<SonarArc> arcs_;
  std::vector<double> explained_;  // log likelihood of the best explanation
  std::vector<int> owner_;         // object it is a member of
  std::vector<char> votes_;        // whether it is in the accumulators
  int unexplained_ = 0;
  int outside_ = 0;  // echoes outside the accumulators, put since these were made

  std::vector<Object> objects_;
};

}  // namespace noctule::mapping
