# loop_r_tables.R FOLDER: measured tables that come with R (datasets, MASS, boot, nlme, lattice), each with a model that
# leaves out what the literature says of it. Writes FOLDER/NAME.csv and FOLDER/cases.json for loop_r_tables.py; the data
# stay R's. What is known is computed here once more, by lm alone, so that the claim can be checked.
suppressPackageStartupMessages({
  library(MASS)
  library(boot)
  library(nlme)
  library(lattice)
})
folder <- commandArgs(trailingOnly = TRUE)[1]
cases <- list()

# ---- what the data themselves say of the known effect ----
p_text <- function(p) if (p < 1e-300) "p < 1e-300" else sprintf("p = %.2g", p)
adds <- function(more) function(d, model) { # an F test of terms added to the declared model
  low <- lm(as.formula(model), d)
  a <- anova(low, update(low, as.formula(paste(". ~ . +", more))))
  sprintf("F = %.3g, %s", a$F[2], p_text(a$`Pr(>F)`[2]))
}
lone <- function(rows) function(d, model) { # studentised beside all of them left out
  fit <- lm(as.formula(model), d[-rows, , drop = FALSE])
  all <- predict(fit, d[rows, , drop = FALSE], se.fit = TRUE)
  y <- d[rows, all.vars(as.formula(model))[1]]
  t <- (y - all$fit) / sqrt(all$se.fit^2 + all$residual.scale^2)
  paste0("t = ", paste(sprintf("%.1f", t), collapse = ", "), if (length(rows) > 1) " beside the others")
}
spreads <- function(by) function(d, model) { # Bartlett's test
  t <- bartlett.test(residuals(lm(as.formula(model), d)), d[[by]])
  sprintf("Bartlett's K2 = %.3g, %s", t$statistic, p_text(t$p.value))
}
neighbours <- function(d, model) {
  r <- residuals(lm(as.formula(model), d))
  n <- length(r)
  c1 <- sum(r[-1] * r[-n]) / sum(r^2)
  sprintf("correlation of neighbours %.2f (%.1f standard errors)", c1, c1 * sqrt(n))
}
cycle <- function(period, by) function(d, model) {
  d$.s <- sin(2 * pi * d[[by]] / period)
  d$.c <- cos(2 * pi * d[[by]] / period)
  adds(".s + .c")(d, model)
}
nothing <- function(d, model) {
  r <- residuals(lm(as.formula(model), d))
  sprintf("largest studentised residual %.1f of %d", max(abs(rstudent(lm(as.formula(model), d)))), length(r))
}

# ---- tables ----
words <- function(x, letter) paste0(letter, as.character(x)) # levels are words, whatever R calls them
frame <- function(...) data.frame(..., stringsAsFactors = FALSE)
series <- function(y, name = "value") {
  d <- frame(reading = seq_along(y), y = as.numeric(y))
  names(d)[2] <- name
  d
}
# model: declared, in the program's words; r: the same in R's where they differ. accepted: any one of them is right.
# weak: one test of it cannot hold against everything that is tried; to be suspected is enough.
case <- function(name, data, model, known, source, evidence, accepted = character(0), options = character(0), r = model, weak = FALSE) {
  response <- all.vars(as.formula(r))[1]
  write.csv(data, file.path(folder, paste0(name, ".csv")), row.names = FALSE, quote = FALSE)
  cases[[length(cases) + 1]] <<- list(
    table = name, response = response, model = model, known = known, source = source,
    evidence = evidence(data, r), accepted = accepted, options = options, rows = nrow(data), weak = as.integer(weak))
}
order_of <- function(column) c("--order", column)
each <- function(id, columns) paste0(id, "(", columns, ")")
rows_wrong <- function(...) paste0("table.outlier(", c(...), ")")

# A series as a table without an order: rows in any order, the month's number of each.
by_month <- function(y, name) {
  d <- frame(month = as.numeric(stats::cycle(y)), year = floor(as.numeric(time(y)) + 1e-6), y = as.numeric(y))
  names(d)[3] <- name
  set.seed(5)
  d[sample(nrow(d)), ]
}

# lone values
case("hills", frame(race = seq_len(nrow(hills)), dist = hills$dist, climb = hills$climb, time = hills$time),
  "time ~ dist + climb", "Knock Hill (row 18) recorded an hour wrong", "Atkinson 1986; Venables and Ripley 2002, 6.3",
  lone(18), rows_wrong(18))
case("newcomb", series(newcomb, "deviation"), "deviation ~ 1", "two wild readings, -44 and -2 (rows 2 and 54)",
  "Newcomb 1891; Stigler 1977", lone(which(newcomb < 0)), as.list(rows_wrong(which(newcomb < 0))), order_of("reading"))
case("forbes", frame(point = seq_len(nrow(forbes)), bp = forbes$bp, log_pres = 100 * log10(forbes$pres)),
  "log_pres ~ bp", "row 12 is wrong", "Forbes 1857; Weisberg 1980", lone(12), rows_wrong(12))
case("phones", frame(year = phones$year, calls = phones$calls), "calls ~ year",
  "1964 to 1969 (rows 15 to 20) are minutes, not calls", "Rousseeuw and Leroy 1987, 2.2", lone(15:20),
  c(rows_wrong(15:20), each("table.threshold", "year"), "unattributed(year)"), order_of("year"))
case("animals", frame(animal = rownames(Animals), log_body = log10(Animals$body), log_brain = log10(Animals$brain)),
  "log_brain ~ log_body", "three dinosaurs (rows 6, 16, 26)", "Rousseeuw and Leroy 1987, 2.7", lone(c(6, 16, 26)),
  rows_wrong(6, 16, 26))
case("stackloss", frame(day = 1:21, air_flow = stackloss$Air.Flow, water = stackloss$Water.Temp,
  acid = stackloss$Acid.Conc., loss = stackloss$stack.loss), "loss ~ air_flow + water + acid",
  "days 1, 3, 4 and 21 do not belong; the air flow acts bent", "Brownlee 1965; Daniel and Wood 1971, 5",
  lone(c(1, 3, 4, 21)), c(rows_wrong(1, 3, 4, 21), "table.quadratic(air_flow)"), order_of("day"))
case("salinity", frame(period = 1:28, lag = salinity$lag, trend = salinity$trend, discharge = salinity$dis,
  sal = salinity$sal), "sal ~ lag + trend + discharge", "the effect of the discharge bends, or rows 16, 5 and 3 are far out",
  "Ruppert and Carroll 1980; Atkinson 1985", adds("I(discharge^2)"),
  c(rows_wrong(16, 5, 3), "table.quadratic(discharge)", "table.threshold(discharge)", "unattributed(discharge)"))

# cycles
case("co2", series(co2, "co2"), "co2 ~ reading + reading^2", "a cycle of a year", "Keeling and Whorf 1997",
  cycle(12, "reading"), "table.periodic(reading)", order_of("reading"), "co2 ~ reading + I(reading^2)")
case("nottem", series(nottem, "temperature_F"), "temperature_F ~ 1", "a cycle of a year", "Anderson 1976, 8.2",
  cycle(12, "reading"), "table.periodic(reading)", order_of("reading"))
case("ukgas", series(log(UKgas), "log_gas"), "log_gas ~ reading", "a cycle of four quarters", "Durbin and Koopman 2001",
  cycle(4, "reading"), "table.periodic(reading)", order_of("reading"))
case("accidents", series(USAccDeaths, "deaths"), "deaths ~ 1", "a cycle of a year", "Brockwell and Davis 1991, 1.1",
  cycle(12, "reading"), "table.periodic(reading)", order_of("reading"))
case("air_passengers", series(log(AirPassengers), "log_passengers"), "log_passengers ~ reading", "a cycle of a year",
  "Box and Jenkins 1976, series G", cycle(12, "reading"), "table.periodic(reading)", order_of("reading"))
case("lung_deaths", series(ldeaths, "deaths"), "deaths ~ 1", "a cycle of a year", "Diggle 1990, A.3",
  cycle(12, "reading"), "table.periodic(reading)", order_of("reading"))
case("nottem_month", by_month(nottem, "temperature_F"), "temperature_F ~ 1", "a cycle of twelve months over the month", "Anderson 1976, 8.2",
  cycle(12, "month"), "table.periodic(month)", c("--period", "month=12"))
case("lung_deaths_month", by_month(ldeaths, "deaths"), "deaths ~ 1", "a cycle of twelve months over the month", "Diggle 1990, A.3",
  cycle(12, "month"), "table.periodic(month)", c("--period", "month=12"))
case("lynx", series(log10(lynx), "log_lynx"), "log_lynx ~ 1", "a cycle of 9.6 years", "Elton and Nicholson 1942; Moran 1953",
  cycle(9.6, "reading"), "table.periodic(reading)", order_of("reading"))
case("sunspots", series(sqrt(sunspot.year), "root_spots"), "root_spots ~ 1", "a cycle of 11 years", "Wolf 1852; Yule 1927",
  cycle(11, "reading"), "table.periodic(reading)", order_of("reading"))
case("melanoma", frame(year = lattice::melanoma$year, incidence = lattice::melanoma$incidence), "incidence ~ year",
  "a cycle of about ten years, as the sunspots'", "Andrews and Herzberg 1985; Cleveland 1993, 3", cycle(10.5, "year"),
  c("table.periodic(year)", "unattributed(year)"), order_of("year"))

# steps, drifts, neighbours
case("nile", frame(year = 1871:1970, flow = as.numeric(Nile)), "flow ~ 1", "a step in 1898", "Cobb 1978",
  function(d, model) adds("I(year > 1898)")(d, model), "table.threshold(year)", order_of("year"))
case("new_haven", frame(year = 1912:1971, temperature_F = as.numeric(nhtemp)), "temperature_F ~ 1", "it gets warmer",
  "Vaux and Brinker 1972, in McNeil 1977", adds("year"), each(c("table.order_drift", "table.linear"), "year"), order_of("year"))
case("lake_huron", frame(year = 1875:1972, level = as.numeric(LakeHuron)), "level ~ year", "neighbouring years are alike",
  "Brockwell and Davis 1991, appendix A", neighbours, "table.serial_correlation(year)", order_of("year"))
case("hormone", series(lh, "lh"), "lh ~ 1", "neighbours are alike", "Diggle 1990, A.1", neighbours,
  c("table.serial_correlation(reading)", "unattributed(reading)"), order_of("reading"))
case("geyser", series(geyser$duration, "duration"), "duration ~ 1", "long after short: neighbours are unlike",
  "Azzalini and Bowman 1990", neighbours, c("table.serial_correlation(reading)", "table.periodic(reading)"),
  order_of("reading"))
case("drivers", frame(month = 1:192, law = words(Seatbelts[, "law"], "L"), log_drivers = log(as.numeric(UKDriverDeaths))), "log_drivers ~ 1",
  "a cycle of a year; the seat belt law of 1983", "Harvey and Durbin 1986",
  function(d, model) paste("cycle", cycle(12, "month")(d, model), "; law", adds("law + sin(2*pi*month/12) + cos(2*pi*month/12)")(d, model)),
  list("table.periodic(month)", c("table.factor(law)", each(c("table.threshold", "table.quadratic"), "month"))), order_of("month"))
case("beaver", frame(reading = seq_len(nrow(beaver2)), activ = words(beaver2$activ, "A"), body_C = beaver2$temp), "body_C ~ 1",
  "warmer when active (from reading 39 on)", "Reynolds 1994", adds("activ"),
  c("table.factor(activ)", "table.threshold(reading)"), order_of("reading"))
case("gravity", frame(reading = seq_len(nrow(gravity)), series = words(gravity$series, "S"), g = gravity$g), "g ~ 1",
  "the eight series differ, most of all in their spread", "Cressie 1982; Davison and Hinkley 1997, 3.1", spreads("series"),
  c("table.spread(series)", "table.factor(series)", "table.spread(reading)"), order_of("reading"))

# bent
case("trees", frame(tree = seq_len(nrow(trees)), girth = trees$Girth, height = trees$Height, volume = trees$Volume), "volume ~ girth + height",
  "quadratic in girth", "Ryan, Joiner and Ryan 1976", adds("I(girth^2)"),
  c("table.quadratic(girth)", "table.interaction(girth, height)"))
case("mercury", frame(temperature_C = pressure$temperature, log_pressure = log(pressure$pressure)),
  "log_pressure ~ temperature_C", "the logarithm goes with 1/T", "Weast 1973", adds("I(1 / (temperature_C + 273.15))"),
  c(each(c("table.quadratic", "process.arrhenius"), "temperature_C")))
case("weight_loss", frame(days = wtloss$Days, weight = wtloss$Weight), "weight ~ days", "it levels off",
  "Venables and Ripley 2002, 8.1", adds("I(days^2)"), c("table.quadratic(days)", "process.log_time(days)", "process.jmak(days)"))
case("motorcycle", frame(times = mcycle$times, accel = mcycle$accel), "accel ~ 1", "a dive and a rebound that no polynomial has",
  "Silverman 1985", adds("poly(times, 8)"), c("unattributed(times)", each(c("table.quadratic", "table.periodic", "table.threshold"), "times")),
  order_of("times"))
case("ethanol", frame(compression = ethanol$C, ratio = ethanol$E, NOx = ethanol$NOx), "NOx ~ compression + ratio",
  "a hump over the equivalence ratio", "Brinkman 1981; Cleveland 1993, 4", adds("I(ratio^2)"),
  c("table.quadratic(ratio)", "unattributed(ratio)"))
case("tooth_growth", frame(supplement = as.character(ToothGrowth$supp), dose = ToothGrowth$dose, length = ToothGrowth$len),
  "length ~ supplement + dose", "it levels off with the dose", "Crampton 1947; Bliss 1952", adds("I(dose^2)"),
  c(each(c("table.quadratic", "table.factor", "table.threshold"), "dose"), "table.interaction(dose, supplement)"))
case("puromycin", frame(concentration = Puromycin$conc, state = as.character(Puromycin$state), rate = Puromycin$rate),
  "rate ~ concentration + state", "it saturates", "Treloar 1974; Bates and Watts 1988, 2", adds("I(concentration^2)"),
  each(c("table.quadratic", "table.factor", "table.threshold"), "concentration"))
case("elisa", frame(run = words(as.character(DNase$Run), "R"), concentration = DNase$conc, density = DNase$density), "density ~ concentration",
  "it saturates", "Davidian and Giltinan 1995, 5.2.4", adds("I(concentration^2)"),
  c(each(c("table.quadratic", "table.factor"), "concentration"), "unattributed(concentration)"))
case("dialyzer", frame(subject = words(as.character(Dialyzer$Subject), "P"), flow = words(Dialyzer$QB, "Q"), pressure = Dialyzer$pressure,
  rate = Dialyzer$rate), "rate ~ flow + pressure", "it saturates with the pressure", "Vonesh and Carter 1992",
  adds("I(pressure^2)"), c("table.quadratic(pressure)", "unattributed(pressure)"))
case("loblolly", frame(seed = words(as.character(Loblolly$Seed), "S"), age = Loblolly$age, height = Loblolly$height), "height ~ age",
  "growth slows down", "Kung 1986", adds("I(age^2)"), c(each(c("table.quadratic", "table.factor"), "age"), "unattributed(age)"))
case("ozone", { a <- na.omit(airquality); frame(day = seq_len(nrow(a)), radiation = a$Solar.R, wind = a$Wind, temp = a$Temp, ozone = a$Ozone) },
  "ozone ~ radiation + wind + temp", "bent in wind and temperature, which interact", "Chambers et al. 1983; Cleveland 1993",
  adds("I(wind^2)"), c(each("table.quadratic", c("wind", "temp")), "table.interaction(temp, wind)", "unattributed(wind)", "unattributed(temp)"))

# groups, levels, interactions
case("barley", frame(variety = gsub(" ", "_", as.character(barley$variety)), site = gsub(" ", "_", as.character(barley$site)),
  year = words(as.character(barley$year), "Y"), yield = barley$yield), "yield ~ variety + site + year", "the years are exchanged at Morris",
  "Cleveland 1993, 6", adds("site:year"), "table.interaction(site, year)")
case("sleep", frame(patient = words(sleep$ID, "P"), drug = words(sleep$group, "D"), extra = sleep$extra), "extra ~ drug",
  "patients differ", "Student 1908", adds("patient"), each(c("table.factor", "table.group_offset"), "patient"))
case("shoes", frame(boy = words(rep(1:10, 2), "B"), material = rep(c("A", "B"), each = 10), wear = c(shoes$A, shoes$B)), "wear ~ material",
  "boys differ", "Box, Hunter and Hunter 1978, 4", adds("boy"), each(c("table.factor", "table.group_offset"), "boy"))
case("rail", frame(rail = words(as.character(Rail$Rail), "R"), travel = Rail$travel), "travel ~ 1", "rails differ", "Devore 2000; Pinheiro and Bates 2000, 1.1",
  adds("rail"), each(c("table.factor", "table.group_offset"), "rail"))
case("machines", frame(worker = words(as.character(Machines$Worker), "W"), machine = as.character(Machines$Machine), score = Machines$score), "score ~ machine",
  "workers differ", "Milliken and Johnson 1992", adds("worker"), c(each(c("table.factor", "table.group_offset"), "worker"), "table.interaction(machine, worker)"))
case("stool", frame(subject = words(as.character(ergoStool$Subject), "P"), type = as.character(ergoStool$Type), effort = ergoStool$effort), "effort ~ type",
  "subjects differ", "Wretenberg, Arborelius and Lindberg 1993", adds("subject"), each(c("table.factor", "table.group_offset"), "subject"))
case("oxide", frame(lot = words(as.character(Oxide$Lot), "L"), site = words(Oxide$Site, "T"), thickness = Oxide$Thickness), "thickness ~ 1", "lots differ",
  "Littell et al. 1996, 4.4", adds("lot"), each(c("table.factor", "table.group_offset"), "lot"))
case("feed", frame(feed = as.character(chickwts$feed), weight = chickwts$weight), "weight ~ 1", "feeds differ", "Snedecor 1948", adds("feed"), "table.factor(feed)")
case("petrol", frame(crude = words(petrol$No, "C"), gravity = petrol$SG, vapour = petrol$VP, v10 = petrol$V10, end_point = petrol$EP, yield = petrol$Y),
  "yield ~ end_point", "crudes differ, as their 10 % point does", "Prater 1956; Venables and Ripley 2002, 6", adds("v10"),
  c("table.factor(crude)", each("table.linear", c("v10", "gravity", "vapour"))))
case("orange", frame(tree = words(as.character(Orange$Tree), "T"), age = Orange$age, girth = Orange$circumference), "girth ~ age",
  "trees grow at rates of their own", "Draper and Smith 1998; Lindstrom and Bates 1990", adds("tree:age"), c("table.factor(tree)", "table.interaction(age, tree)"))
case("grass", frame(plant = as.character(CO2$Plant), type = as.character(CO2$Type), treatment = as.character(CO2$Treatment), conc = CO2$conc, uptake = CO2$uptake),
  "uptake ~ conc", "plants of Quebec take up more than those of Mississippi", "Potvin, Lechowicz and Tardif 1990", adds("type"),
  c("table.factor(type)", "table.factor(plant)"))

# spread
case("insects", frame(spray = as.character(InsectSprays$spray), count = InsectSprays$count), "count ~ spray", "the spread goes with the mean", "Beall 1942",
  spreads("spray"), "table.spread(spray)")
case("orchard", frame(row = OrchardSprays$rowpos, column = OrchardSprays$colpos, treatment = as.character(OrchardSprays$treatment), decrease = OrchardSprays$decrease),
  "decrease ~ treatment", "the spread goes with the mean", "Finney 1947", spreads("treatment"), "table.spread(treatment)")
case("poisons", frame(poison = words(poisons$poison, "P"), treat = as.character(poisons$treat), survival = poisons$time), "survival ~ poison * treat",
  "the spread goes with the mean", "Box and Cox 1964", spreads("poison"), each("table.spread", c("poison", "treat")))

# weak: one test of them alone shows them, a search over everything cannot prove them
case("npk", frame(block = words(npk$block, "B"), N = words(npk$N, "n"), P = words(npk$P, "p"), K = words(npk$K, "k"), yield = npk$yield), "yield ~ N * P * K",
  "blocks differ", "Venables and Ripley 2002, 6.7", adds("block"), "table.factor(block)", weak = TRUE)
case("genotype", frame(litter = words(genotype$Litter, "L"), mother = words(genotype$Mother, "M"), weight = genotype$Wt), "weight ~ litter",
  "foster mothers differ", "Bailey 1953; Venables and Ripley 2002", adds("mother"), "table.factor(mother)", weak = TRUE)
case("cabbages", frame(cultivar = as.character(cabbages$Cult), date = as.character(cabbages$Date), head_weight = cabbages$HeadWt), "head_weight ~ cultivar",
  "planting dates differ", "Rawlings 1988", adds("date"), c("table.factor(date)", "table.interaction(cultivar, date)"), weak = TRUE)
case("warp", frame(wool = as.character(warpbreaks$wool), tension = as.character(warpbreaks$tension), breaks = warpbreaks$breaks), "breaks ~ wool + tension",
  "wool and tension interact; the spread goes with the mean", "Tippett 1950; Tukey 1977", adds("wool:tension"),
  c("table.interaction(wool, tension)", each("table.spread", c("wool", "tension", "the level of breaks"))), weak = TRUE)
case("gun", frame(team = words(as.character(Gun$Team), "T"), physique = as.character(Gun$Physique), method = as.character(Gun$Method), rounds = Gun$rounds),
  "rounds ~ method", "teams differ", "Hicks 1964; Pinheiro and Bates 2000, 2", adds("team"), c("table.factor(team)", "table.factor(physique)"), weak = TRUE)
case("swiss", frame(agriculture = swiss$Agriculture, education = swiss$Education, catholic = swiss$Catholic, infant_mortality = swiss$Infant.Mortality,
  fertility = swiss$Fertility), "fertility ~ agriculture + education + catholic", "fertility goes with the mortality of infants", "Mosteller and Tukey 1977",
  adds("infant_mortality"), "table.linear(infant_mortality)", weak = TRUE)
case("morley", frame(row = seq_len(nrow(morley)), experiment = words(morley$Expt, "E"), speed = morley$Speed), "speed ~ 1",
  "the five experiments differ; rows are sorted by them", "Michelson 1882; Weekes 1986", adds("experiment"), "table.factor(experiment)", weak = TRUE)

# rows sorted or nested by columns: the row's number is no order
case("coop", frame(row = seq_len(nrow(coop)), lab = as.character(coop$Lab), specimen = as.character(coop$Spc), batch = as.character(coop$Bat), conc = coop$Conc),
  "conc ~ specimen", "laboratories differ", "Analytical Methods Committee 1987", adds("lab"), "table.factor(lab)")
case("oats", frame(row = seq_len(nrow(oats)), block = as.character(oats$B), variety = gsub("\\.", "_", oats$V), nitrogen = as.character(oats$N), yield = oats$Y),
  "yield ~ variety + nitrogen", "blocks differ", "Yates 1935; Venables and Ripley 2002, 10", adds("block"), "table.factor(block)")
case("immer", frame(row = seq_len(nrow(immer)), place = as.character(immer$Loc), variety = as.character(immer$Var), yield_1931 = immer$Y1), "yield_1931 ~ variety",
  "places differ", "Immer, Hayes and Powers 1934", adds("place"), "table.factor(place)")
case("alfalfa", frame(row = seq_len(nrow(Alfalfa)), variety = as.character(Alfalfa$Variety), date = as.character(Alfalfa$Date), block = words(as.character(Alfalfa$Block), "B"),
  yield = Alfalfa$Yield), "yield ~ variety + date", "blocks differ", "Snedecor and Cochran 1980, 16.15", adds("block"), "table.factor(block)")

# nothing left
case("feed_known", frame(feed = as.character(chickwts$feed), weight = chickwts$weight), "weight ~ feed", "nothing", "Snedecor 1948", nothing)
case("plants_known", frame(group = as.character(PlantGrowth$group), weight = PlantGrowth$weight), "weight ~ group", "nothing", "Dobson 1983", nothing)
case("rail_known", frame(rail = words(as.character(Rail$Rail), "R"), travel = Rail$travel), "travel ~ rail", "nothing", "Devore 2000", nothing)
case("stool_known", frame(subject = words(as.character(ergoStool$Subject), "P"), type = as.character(ergoStool$Type), effort = ergoStool$effort),
  "effort ~ type + subject", "nothing", "Wretenberg, Arborelius and Lindberg 1993", nothing)
case("nile_known", frame(year = 1871:1970, dam = ifelse(1871:1970 > 1898, "after", "before"), flow = as.numeric(Nile)), "flow ~ dam", "nothing", "Cobb 1978",
  nothing, options = order_of("year"))
case("forbes_known", frame(bp = forbes$bp[-12], log_pres = 100 * log10(forbes$pres[-12])), "log_pres ~ bp", "nothing", "Weisberg 1980", nothing)

# ---- cases.json ----
text <- function(x) paste0('"', gsub('"', '\\\\"', x), '"')
many <- function(x) paste0("[", paste(x, collapse = ", "), "]")
json <- function(x) if (is.numeric(x)) format(x) else text(x)
line <- function(c) {
  findings <- if (is.list(c$accepted)) c$accepted else if (length(c$accepted)) list(c$accepted) else list()
  c$accepted <- many(vapply(findings, function(f) many(text(f)), ""))
  c$options <- many(if (length(c$options)) text(c$options) else character(0))
  ready <- names(c) %in% c("accepted", "options")
  paste0("{", paste0(text(names(c)), ": ", ifelse(ready, unlist(c), vapply(c, json, "")), collapse = ", "), "}")
}
writeLines(c("[", paste(vapply(cases, line, ""), collapse = ",\n"), "]"), file.path(folder, "cases.json"))
