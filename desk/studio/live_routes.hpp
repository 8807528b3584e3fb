#pragma once

namespace offnominal::desk::studio {

class Api;
class Stage;

/// The part of the API that is of a live view. `stage` has to outlive the server.
void set_up_live_routes(Api& api, Stage& stage);

}  // namespace offnominal::desk::studio
