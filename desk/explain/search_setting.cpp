#include "explain/search_setting.hpp"

#include <utility>

namespace offnominal::desk {

SearchSetting setting_of(NuisanceOptions nuisance, std::unique_ptr<Data> data,
                         std::unique_ptr<Data> held_out, const SearchOptions& options) {
  SearchSetting made;
  made.nuisance = std::move(nuisance);
  made.data = std::move(data);
  made.held_out = std::move(held_out);
  made.regression = std::make_unique<Regression>(*made.data);
  made.hold_out = std::make_unique<HoldOut>(*made.regression, made.held_out.get());
  made.search = std::make_unique<Search>(*made.regression, options);
  return made;
}

SearchSetting beside(const SearchSetting& same, const RobotDescription& robot,
                     const NuisanceOptions& nuisance) {
  return setting_of(
      nuisance, std::make_unique<Data>(*same.data, robot, nuisance),
      same.held_out ? std::make_unique<Data>(*same.held_out, robot, nuisance) : nullptr,
      same.search->options());
}

}  // namespace offnominal::desk
