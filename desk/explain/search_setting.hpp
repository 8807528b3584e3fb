#pragma once

#include <memory>

#include "explain/search.hpp"
#include "identify/holdout.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// What one search is made in: the recordings beside one nuisance, what is held out, and the
// candidates' regressors. What it finds points into it.
struct SearchSetting {
  NuisanceOptions nuisance;
  std::unique_ptr<Data> data;
  std::unique_ptr<Data> held_out;  // null: parts of the fitted ones
  std::unique_ptr<Regression> regression;
  std::unique_ptr<HoldOut> hold_out;
  std::unique_ptr<Search> search;
};

SearchSetting setting_of(NuisanceOptions nuisance, std::unique_ptr<Data> data,
                         std::unique_ptr<Data> held_out, const SearchOptions& options);

// The same recordings of the same robot beside another nuisance.
SearchSetting beside(const SearchSetting& same, const RobotDescription& robot,
                     const NuisanceOptions& nuisance);

}  // namespace offnominal::desk
